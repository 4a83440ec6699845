// campaign.db: what is in it stays, and a result is there once.

#include "base/error.h"
#include "base/random.h"
#include "campaigns/engine/store.h"
#include "campaigns/engine/table.h"
#include "campaigns/jobs/result_files.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <fstream>

using namespace puckloop;
using namespace puckloop::faults;

namespace {

struct Folder {
    Folder() : path(tests::scratch_path("store")) { std::filesystem::create_directories(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    std::filesystem::path path;
};

std::vector<Case> some_cases(int count) {
    std::vector<Case> cases;
    for (int i = 1; i <= count; ++i)
        cases.push_back({.id = i,
                         .phase = "single",
                         .sweep = "a, \"b\"",
                         .place = "",
                         .seed = static_cast<std::uint64_t>(i),
                         .faults = {{{"kind", "drop"}, {"link", "r.uart"}}},
                         .of = 0,
                         .pruned = i % 4 == 0 ? "why not" : ""});
    return cases;
}

Verdict verdict_of(std::uint64_t fired) {
    Verdict verdict;
    verdict.fired = {fired};
    verdict.symptoms = {"it's, \"so\""};
    return verdict;
}

}  // namespace

TEST_CASE("results come back in order, once each, after the database was closed") {
    const Folder folder;
    RandomStream random(GENERATE(1, 2, 3), "store");
    {
        Store store(folder.path / "campaign.db", Store::Access::Write);
        CHECK(!store.planned("single"));
        store.plan("single", some_cases(12));
        CHECK(store.pending("single").size() == 9);
        for (int i = 0; i < 5; ++i) {
            const auto left = store.pending("single");
            const int id = left.at(random.below(left.size())).id;
            store.add_result(id, to_json(verdict_of(static_cast<std::uint64_t>(id))));
            store.add_result(id, to_json(verdict_of(99)));  // the first one stays
        }
        CHECK_THROWS_AS(store.plan("single", some_cases(3)), RunError);
    }
    const Store store(folder.path / "campaign.db", Store::Access::Read);
    CHECK(store.planned("single"));
    CHECK(store.pending("single").size() == 4);
    CHECK(store.pruned().size() == 3);
    const auto results = store.results();
    REQUIRE(results.size() == 5);
    int before = 0;
    for (const CaseResult& result : results) {
        CHECK(result.one.id > before);
        before = result.one.id;
        CHECK(result.verdict.fired == std::vector<std::uint64_t>{static_cast<std::uint64_t>(before)});
    }
    const std::string table = table_text({{}, folder.path, results, store.pruned()});
    CHECK(std::count(table.begin(), table.end(), '\n') == 9);
    CHECK(table.find("\"a, \"\"b\"\"\"") != std::string::npos);
}

TEST_CASE("what is no campaign's database is refused") {
    const Folder folder;
    const auto file = folder.path / "campaign.db";
    CHECK_THROWS_AS(Store(file, Store::Access::Read), InputError);
    std::ofstream(file) << std::string(4096, 'z');
    CHECK_THROWS_AS(Store(file, Store::Access::Read), InputError);
    CHECK_THROWS_AS(Store(file, Store::Access::Write), InputError);
    CHECK_THROWS_AS(Store(folder.path / "no" / "campaign.db", Store::Access::Write), RunError);
    CHECK_THROWS_AS(jobs::write_whole("/dev/full/x", "text"), RunError);
}
