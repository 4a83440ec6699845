#include "base/logs/node_log.h"

#include "base/error.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>

using namespace puckloop;

namespace {}  // namespace

TEST_CASE("lines carry their time, replace an older file and are there before the log is closed") {
    const auto file = puckloop::tests::scratch_path("puckloop-node-log-test.log");
    std::ofstream(file) << "of an earlier run\n";
    NodeLog log(file.string());
    log.line(17.630123, "robot0 touches carton");
    log.line(1234567.0, "late");
    CHECK(tests::text_of(file) == "[   17.630123 s] robot0 touches carton\n[1234567.000000 s] late\n");
    std::filesystem::remove(file);
}

TEST_CASE("without a path there is no log") {
    NodeLog log;
    CHECK_FALSE(log.is_open());
    log.line(1, "nowhere");
}

TEST_CASE("a log that cannot be written is named, once") {
    CHECK_THROWS_WITH(NodeLog("/nonexistent/robot0.pic.log"), Catch::Contains("/nonexistent/robot0.pic.log"));
    if (!std::filesystem::exists("/dev/full")) return;
    NodeLog log("/dev/full");
    CHECK_THROWS_AS(log.line(0, "no room"), RunError);
    CHECK_FALSE(log.is_open());
    CHECK_NOTHROW(log.line(1, "still none"));
}

TEST_CASE("milestones are the powers of two") {
    int told = 0;
    for (std::uint64_t count = 0; count <= 1024; ++count)
        told += is_milestone(count);
    CHECK(told == 11);
    CHECK_FALSE(is_milestone(0));
    CHECK(is_milestone(1));
}
