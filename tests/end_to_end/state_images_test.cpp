// The original firmware (PUCKLOOP_IMAGES), which listens after 39.5 s, started from the cache and from a
// state.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <cstdlib>

using namespace puckloop::tests;

TEST_CASE("the original firmware's boot is skipped, and the run is the same") {
    const auto image = outside("PUCKLOOP_IMAGES", "epuck_firmware.hex");
    if (!image) {
        WARN("PUCKLOOP_IMAGES has no epuck_firmware.hex: skipped");
        return;
    }
    const Workbench bench;
    ::setenv("PUCKLOOP_CACHE", (bench.folder() / "cache").c_str(), 1);
    const std::string scenario = PUCKLOOP_SOURCE "/scenarios/own_binaries.toml";
    const auto run = [&](const std::string& name, Words more) {
        Words words{scenario,     "--firmware", "robot0.pic=" + image->string(),
                    "--duration", "45",         "--in-process"};
        words.insert(words.end(), more.begin(), more.end());
        const Ended ended = bench.run(name, words);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        return ended.out;
    };
    run("plain", {"--no-cache"});
    run("first", {});
    CHECK_THAT(run("second", {}), Catch::Contains("robot0.pic: boot of 42 s skipped, from cache"));
    const auto state = (bench.folder() / "ready.state").string();
    run("saving", {"--save-state", state, "--at", "40s"});
    CHECK_THAT(run("from", {"--from-state", state}), Catch::Contains("robot0.pic: from its state at 40 s"));
    ::setenv("PUCKLOOP_CACHE", "off", 1);
    for (const char* name : {"first", "second", "saving", "from"})
        check_same_run(bench, "plain", name);
    CHECK(bytes_sent(bench.csv("second", "trace.csv"), "robot0.uart", "robot0.pic").size() > 1000);
}
