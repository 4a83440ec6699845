// `puckloop gap new`: what it writes is understood, and says what is still to be done.

#include "gap/begin/new_folder.h"
#include "gap/begin/readiness.h"
#include "gap/kinds/columns.h"
#include "tests/gap/bad_input/made_experiment.h"

#include <catch2/catch.hpp>

using namespace puckloop::gap;
using namespace puckloop::gap::tests;
using Catch::Matchers::Contains;

namespace {

constexpr Kind::Builtin kKinds[] = {Kind::Proximity, Kind::Motion,        Kind::Rab,   Kind::Microphone,
                           Kind::Ground,    Kind::Accelerometer, Kind::Timing};

}  // namespace

TEST_CASE("a new folder of every kind lacks nothing but rows") {
    for (const Kind kind : kKinds) {
        const Folder folder;
        write_new_folder(kind, 3, folder.path() / "fresh");
        const Readiness ready = readiness_of(folder.path() / "fresh", 1);
        INFO(readiness_text(ready));
        CHECK(ready.experiment->kind == kind);
        REQUIRE(ready.problems.size() == 3);
        for (const std::string& problem : ready.problems)
            CHECK_THAT(problem, Contains("has no rows"));
    }
}

TEST_CASE("every column of a kind is described, and what is required is in the header") {
    for (const Kind kind : kKinds) {
        const std::string toml = new_experiment_toml(kind, 1), header = "," + new_csv_header(kind);
        for (const ColumnInfo& column : columns_of(kind)) {
            INFO(kind_name(kind) << " " << column.name);
            CHECK_THAT(toml, Contains(fmt::format("# {} ", column.name)) && Contains(column.meaning));
            if (column.required)
                CHECK((header.find(fmt::format(",{},", column.name)) != std::string::npos ||
                       header.find(fmt::format(",{}\n", column.name)) != std::string::npos));
        }
    }
}

TEST_CASE("a folder that was begun and filled is read like one written by hand") {
    for (const Kind kind : kKinds) {
        const Made made = clean(std::string(kind_name(kind)));
        const Folder by_hand(made);
        const auto fresh = by_hand.path() / "fresh";
        write_new_folder(kind, 3, fresh);
        for (int run = 0; run < 3; ++run)
            std::filesystem::copy_file(by_hand.path() / fmt::format("run{}.csv", run),
                                       fresh / fmt::format("run{}.csv", run + 1),
                                       std::filesystem::copy_options::overwrite_existing);
        const Readiness ready = readiness_of(fresh, 1);
        INFO(readiness_text(ready));
        CHECK(ready.problems.empty());
        CHECK(ready.experiment->rows() == readiness_of(by_hand.path(), 1).experiment->rows());
    }
}

TEST_CASE("nothing that is there is written over") {
    const Folder folder;
    const auto begun = folder.path() / "begun", other = folder.path() / "other";
    write_new_folder(Kind::Ground, 2, begun);
    CHECK_THROWS_AS(write_new_folder(Kind::Ground, 2, begun), puckloop::InputError);
    std::filesystem::create_directories(other);
    write_file(other / "run2.csv", "measured\n");
    CHECK_THROWS_AS(write_new_folder(Kind::Ground, 2, other), puckloop::InputError);
    CHECK_FALSE(std::filesystem::exists(other / "experiment.toml"));
}
