// The host's log: -v, --log-level, --log-file.

#include "tests/end_to_end/kit/one_line.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <regex>
#include <sstream>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

const std::string kHello = PUCKLOOP_SOURCE "/scenarios/hello.toml";

struct Line {
    std::string level, process, text;
    int id = 0;
};

/// Every line of the log; a line of another shape fails the test.
std::vector<Line> lines_of(const std::string& log) {
    static const std::regex shape(R"(\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3} (\w+) +\[(\S+) (\d+)\] (.+))");
    std::vector<Line> lines;
    std::istringstream text(log);
    for (std::string line; std::getline(text, line);) {
        std::smatch parts;
        INFO(line);
        REQUIRE(std::regex_match(line, parts, shape));
        lines.push_back({parts[1], parts[2], parts[4], std::stoi(parts[3])});
    }
    return lines;
}

bool says(const std::vector<Line>& lines, const std::string& process, const std::string& pattern) {
    const std::regex wanted(pattern);
    return std::any_of(lines.begin(), lines.end(), [&](const Line& line) {
        return line.process == process && std::regex_search(line.text, wanted);
    });
}

}  // namespace

TEST_CASE("run prints nothing of its own work unless it is asked") {
    const Workbench bench;
    const Ended plain = bench.run("o", {kHello, "--duration", "0.1"});
    CHECK(plain.status == 0);
    CHECK(plain.err.empty());
}

TEST_CASE("run -v logs what was read, where each node lives, how fast it went and why it ended") {
    const Workbench bench;
    const Ended ended = bench.run("o", {kHello, "--duration", "0.5", "-v"});
    CHECK(ended.status == 0);
    const auto lines = lines_of(ended.err);
    CHECK(says(lines, "puckloop", "read .*epuck.hex: Intel HEX"));
    CHECK(says(lines, "puckloop", "link robot0.uart: .*115200 baud"));
    CHECK(says(lines, "puckloop", "nodes started in"));
    CHECK(says(lines, "puckloop", "ended: the asked duration"));
    CHECK(says(lines, "puckloop", "grants \\([0-9]+ a second\\)"));
    for (const std::string node : {"world", "robot0.pic", "robot0.i2c", "robot0.linux"}) {
        INFO(node);
        const auto own =
            std::find_if(lines.begin(), lines.end(), [&](const Line& line) { return line.process == node; });
        REQUIRE(own != lines.end());
        CHECK(says(lines, "puckloop", fmt::format("node {}: process {}$", node, own->id)));
        CHECK(says(lines, node, "ends with status 0"));
    }
    CHECK(bench.report("o")["trace_sha256"] ==
          (bench.run("p", {kHello, "--duration", "0.5"}), bench.report("p")["trace_sha256"]));
}

TEST_CASE("run --log-file takes the lines of all processes, appended, and none goes to the terminal") {
    const Workbench bench;
    const std::string file = bench.folder() / "host.log";
    for (const Words& more : {Words{}, Words{"--in-process"}, Words{"--log-level", "debug"}}) {
        Words words{kHello, "--duration", "0.2", "--log-file", file};
        words.insert(words.end(), more.begin(), more.end());
        const Ended ended = bench.run("o", words);
        CHECK(ended.status == 0);
        CHECK(ended.err.empty());
    }
    const auto lines = lines_of(text_of(file));
    CHECK(says(lines, "robot0.pic", "read .*epuck.hex"));
    CHECK(says(lines, "puckloop", "node robot0.pic: in this process"));
    CHECK(says(lines, "puckloop", "node robot0.pic: [0-9]+ grants"));  // debug
    CHECK(std::any_of(lines.begin(), lines.end(), [](const Line& line) { return line.level == "debug"; }));
}

TEST_CASE("programs do not see the log in their environment") {
    const Workbench bench;
    const std::string env = bench.file("show", "#!/bin/sh\nexec env\n");
    std::filesystem::permissions(env, std::filesystem::perms::owner_all);
    bench.run("o", {bench.hello(), "-v", "--linux", env});
    const std::string shown = text_of(bench.out("o") / "robot0.linux.log");
    CHECK_THAT(shown, Contains("PATH="));
    CHECK_THAT(shown, !Contains("PUCKLOOP_LOG"));
}

TEST_CASE("exec has the same log under its own name") {
    const Workbench bench;
    const Ended ended = bench.puckloop(
        {"exec", "--board", "pic", PUCKLOOP_SOURCE "/firmware/epuck/epuck.hex", "--seconds", "0.1", "-v"});
    CHECK(ended.status == 0);
    const auto lines = lines_of(ended.err);
    CHECK(says(lines, "exec", "read .*epuck.hex"));
    CHECK(says(lines, "exec", "ended after"));
}

TEST_CASE("a bad level and a log that cannot be written are one line each") {
    const Workbench bench;
    check_one_line(bench.run("o", {kHello, "--log-level", "loud"}), 2,
                   {"--log-level", "'loud'", "trace, debug"});
    const std::string nowhere = bench.folder() / "nowhere/log";
    check_one_line(bench.run("o", {kHello, "--log-file", nowhere}), 2, {"nowhere/log", "cannot be opened"});
    CHECK(!std::filesystem::exists(bench.out("o")));
}
