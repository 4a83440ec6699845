// Cells missing in columns that the models predict from: nothing is put there that nobody measured.

#include "gap/pipeline/analyse.h"
#include "gap/reading/read_experiment.h"
#include "tests/gap/bad_input/made_experiment.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::gap;
using namespace puckloop::gap::tests;
using Catch::Matchers::Contains;

namespace {

/// Every third cell of a column is empty.
Made holed(const Made& made, const std::string& name) {
    return changed(made, name, [](std::size_t i, double value) {
        return i % 3 == 1 ? "" : fmt::format("{:.9g}", value);
    });
}

Made with(Made made, const std::string& name, const std::function<double(std::size_t)>& value) {
    made.names.insert(made.names.begin(), name);
    for (std::size_t i = 0; i < made.rows.size(); ++i)
        made.rows[i].insert(made.rows[i].begin(), fmt::format("{:.9g}", value(i)));
    return made;
}

Experiment read(const Made& made) {
    const Folder folder(made);
    return read_experiment(folder.path());
}

std::string said(const Experiment& experiment) {
    std::string all;
    for (const std::string& caution : experiment.cautions)
        all += caution + "\n";
    return all;
}

}  // namespace

TEST_CASE("a column with one value is filled with it") {
    const Experiment e = read(holed(with(clean("timing"), "bytes", [](std::size_t) { return 84; }), "bytes"));
    for (const Run& run : e.runs)
        for (const double bytes : run.column("bytes"))
            CHECK(bytes == 84);
    CHECK_THAT(said(e),
               Contains("bytes is missing in 81 of 240 rows (3 runs), filled with the run's only value"));
}

TEST_CASE("missing cells of the bytes on the line do not make batches") {
    const Folder folder;
    RandomStream random(1, "gap/missing");
    std::string toml = "kind = \"timing\"\n";
    for (int r = 0; r < 4; ++r) {
        std::string csv = "seq,t_robot_s,t_host_s,bytes\n";
        for (int i = 0; i < 80; ++i)
            csv += fmt::format("{},{:.6f},{:.6f},{}\n", i, 1 + 0.1 * i,
                               1.004 + 0.1 * i + 5e-4 * random.normal(), random.uniform() < 0.4 ? "" : "84");
        write_file(folder.path() / fmt::format("run{}.csv", r), csv);
        toml += fmt::format("[[run]]\nfile = \"run{}.csv\"\n", r);
    }
    write_file(folder.path() / "experiment.toml", toml);
    const Verdict verdict = analyse(read_experiment(folder.path()), {});
    CHECK(verdict.decision == Decision::NoEffect);
}

TEST_CASE("a reading whose stimulus is not known is left out, another row's stays") {
    const Experiment e = read(holed(clean("proximity"), "angle_rad"));
    const auto &reading = e.runs[0].column("reading"), &angle = e.runs[0].column("angle_rad");
    for (std::size_t i = 0; i < reading.size(); ++i)
        CHECK(std::isnan(reading[i]) == std::isnan(angle[i]));
    CHECK_THAT(said(e), Contains("angle_rad is missing in 60 of 180 rows (3 runs), which are left out"));
    Made most = changed(clean("proximity"), "angle_rad", [](std::size_t i, double value) {
        return i % 3 != 1 ? "" : fmt::format("{}", value);
    });
    CHECK_THAT(refusal(most), Contains("angle_rad is missing in 40 of 60 rows that have reading"));
}

TEST_CASE("covariates go on between the rows that have them") {
    Experiment e = read(holed(
        with(clean("ground"), "battery_v", [](std::size_t i) { return 4 - 0.01 * static_cast<double>(i); }),
        "battery_v"));
    for (std::size_t i = 0; i < 59; ++i)
        CHECK(e.runs[0].column("battery_v")[i] == Approx(4 - 0.01 * static_cast<double>(i)));
    e = read(
        holed(with(clean("ground"), "ambient", [](std::size_t i) { return i < 30 ? 0 : 1; }), "ambient"));
    for (std::size_t i = 0; i < 60; ++i)
        CHECK(e.runs[0].column("ambient")[i] == (i < 30 ? 0 : 1));
}

TEST_CASE("whether a message came is known without its stimulus") {
    const Experiment e = read(
        holed(with(clean("rab"), "senders", [](std::size_t i) { return 1 + static_cast<double>(i % 2); }),
              "senders"));
    for (std::size_t i = 0; i < e.runs[0].rows; ++i) {
        CHECK(e.runs[0].column("received")[i] == 1);
        CHECK(std::isnan(e.runs[0].column("strength")[i]) == (i % 3 == 1));
        CHECK(!std::isnan(e.runs[0].column("senders")[i]));
    }
}
