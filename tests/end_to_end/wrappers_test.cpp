// A control program as people start it: from a script, behind env and timeout, into tee, from Python.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/same_run.h"

#include <catch2/catch.hpp>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

const std::string kControl = PUCKLOOP_CONTROL;
const std::string kDrive = kControl + " --behaviour wander --duration 2";

/// Runs hello.toml with the script `text` before its program: in separate processes, in one, and again.
void check_wrapper(const std::string& text) {
    const Workbench bench;
    // In a folder of its own: Python lists its script's folder, where results would make a difference.
    std::filesystem::create_directory(bench.folder() / "bin");
    const std::string wrapper = bench.file("bin/wrapper", text);
    std::filesystem::permissions(wrapper, std::filesystem::perms::owner_all);
    CAPTURE(text);
    for (const char* name : {"a", "b", "c"}) {
        Words words{bench.hello(), "--duration", "10"};
        if (*name == 'b') words.push_back("--in-process");
        words.insert(words.end(),
                     {"--linux", wrapper, kControl, "--behaviour", "wander", "--", "--duration", "2"});
        const Ended ended = bench.run(name, words);
        CHECK(ended.err.empty());
        CHECK(ended.status == 0);
        const auto report = bench.report(name);
        CHECK(report["ended_by"] == "node stopped");
        CHECK(report["simulated_s"].get<double>() == Approx(2.93).margin(0.05));
        CHECK(report["nodes"]["robot0.linux"]["uart"]["received"] > 1000);
        CHECK_THAT(text_of(bench.out(name) / "robot0.linux.log"), Contains("not answered 0"));
    }
    check_same_run(bench, "a", "b");
    check_same_run(bench, "a", "c");
}

}  // namespace

TEST_CASE("wrappers and children drive the robot, the same in both placements and again") {
    check_wrapper("#!/bin/sh\nexec \"$@\"\n");
    check_wrapper("#!/bin/sh\nexec /usr/bin/env -i FOO=1 stdbuf -oL nice timeout 30 " + kDrive + "\n");
    check_wrapper("#!/bin/sh\n" + kDrive + " | tee /dev/null\necho done\n");
}

TEST_CASE("a Python script drives the robot through a child, the same in both placements and again") {
    if (!std::filesystem::exists("/usr/bin/python3")) {
        WARN("/usr/bin/python3 is not there: skipped");
        return;
    }
    check_wrapper("#!/usr/bin/python3\nimport subprocess\nsubprocess.run(\"" + kDrive + "\".split())\n");
}
