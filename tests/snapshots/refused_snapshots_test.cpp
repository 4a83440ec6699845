// What a snapshot cannot go on with is refused, in one line that states why.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <fstream>

using namespace puckloop::tests;
namespace fs = std::filesystem;

namespace {

/// A program that behaves otherwise from its second start on: `mark` is a file that it leaves.
std::string fickle(const fs::path& mark) {
    const std::string control = std::string("exec ") + PUCKLOOP_CONTROL + " --duration 55 --behaviour ";
    return "#!/bin/bash\nif [ -e " + mark.string() + " ]; then " + control + "follow; fi\ntouch " +
           mark.string() + "\n" + control + "wander\n";
}

}  // namespace

TEST_CASE("snapshots of another run, and options that contradict them, are refused") {
    const Workbench bench;
    const fs::path scenario = bench.hello();
    const fs::path file = bench.folder() / "run.snap";
    REQUIRE(bench
                .run("saving",
                     {scenario, "--duration", "1.5", "--save-at", "1.2s", "--save", file, "--in-process"})
                .status == 0);
    fs::create_directories(bench.out("refused"));
    bench.file("refused/trace.csv", "of an earlier run\n");
    bench.file("refused/.puckloop", "trace.csv\n");
    const auto refused = [&](Words words, const Words& said) {
        words.insert(words.begin(), {"--from", file});
        check_one_line(bench.run("refused", words), 2, said);
        CHECK(text_of(bench.out("refused") / "trace.csv") == "of an earlier run\n");
    };
    refused({scenario.string()}, {"--from", "whatever a scenario gives"});
    refused({"--seed", "3"}, {"--from", "--seed"});
    refused({"--record"}, {"--record", "lacks the messages before it"});
    refused({"--realtime"}, {"--from", "real time"});
    refused({"--duration", "1"}, {"--duration", "1 s is before the snapshot, 1.2 s"});
    refused({"--save-at", "1"}, {"--save-at TIME --save FILE"});
    refused({"--save-at", "1", "--save", bench.folder() / "b.snap"},
            {"1 s is not after the snapshot that the run goes on from, 1.2 s"});
    refused({"--fault", "hang node=robot0.pic begin=\"1 s\""},
            {"run.snap", "fault robot0.pic.hang", "begins at 1 s, before the snapshot", "1.2 s\" or later"});
    refused({"--fault", "drop link=robot0.uart begin=\"1 s\" count=1"},
            {"run.snap", "robot0.uart", "would have changed what arrived at", "before the snapshot"});
    const std::string text = text_of(scenario);
    const auto change = [&](const std::string& what, const std::string& with, const Words& said) {
        std::string other = text;
        other.replace(other.find(what), what.size(), with);
        bench.file("hello.toml", other);
        refused({}, said);
    };
    change("30 deg", "31 deg", {"run.snap: world: its world is another than when it was saved"});
    change("\"wander\"", "\"rest\"", {"run.snap: robot0.linux: its args is another"});
    change("robot0", "robot7", {"run.snap: robot7"});
    bench.file("hello.toml", text);
    std::string bytes = text_of(file);
    std::ofstream(file, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
    refused({}, {"run.snap: is damaged"});
    fs::remove(file);
    refused({}, {"run.snap: cannot be read"});
}

TEST_CASE("a program that behaves differently on its second run is named") {
    const Workbench bench;
    const fs::path mark = bench.folder() / "mark";
    const fs::path program = bench.file("fickle", fickle(mark));
    fs::permissions(program, fs::perms::owner_all);
    std::string text = text_of(bench.hello());
    text.replace(text.find("\"puckloop-control\""), 18, '"' + program.string() + '"');
    const fs::path file = bench.folder() / "run.snap";
    const Ended saved = bench.run("saving", {bench.file("fickle.toml", text), "--duration", "2", "--save-at",
                                             "1.8", "--save", file, "--in-process"});
    INFO(saved.err);
    REQUIRE(saved.status == 0);
    for (const char* placement : {"--in-process", "--no-cache"})
        check_one_line(bench.run("on", {"--from", file, placement}), 1,
                       {"robot0.linux: executed again it does not send what it sent"});
    fs::remove(mark);
    CHECK(bench.run("on", {"--from", file, "--in-process"}).status == 0);
}

TEST_CASE("a run that ends before its snapshot has failed") {
    const Workbench bench;
    std::string text = text_of(bench.hello());
    text.replace(text.find("\"55\""), 4, "\"1\"");
    const Ended ended = bench.run("short", {bench.file("short.toml", text), "--save-at", "1", "--save-at",
                                            "30", "--save", bench.folder() / "a.snap", "--in-process"});
    check_one_line(ended, 1, {"no snapshot at 30 s: the run ended at "});
    CHECK(fs::exists(bench.folder() / "a-1s.snap"));
    CHECK_FALSE(fs::exists(bench.folder() / "a-30s.snap"));
}

TEST_CASE("a snapshot that is due while programs end does not end them") {
    const Workbench bench;
    const fs::path scenario =
        bench.hello("[[robot]]\nname = \"failing\"\nposition = [\"-30 cm\", \"25 cm\"]\n"
                    "[robot.pic]\nfirmware = \"own\"\n[robot.linux]\n"
                    "program = [\"/bin/false\"]\nstart = \"1.3 s\"\n");
    // The other program is asked to end 10 ms later, and takes its time.
    bench.run("whole", {scenario, "--in-process"});
    const auto whole = bench.report("whole");
    const double asked = whole["programs_asked_to_end_s"].get<double>(),
                 end = whole["simulated_s"].get<double>();
    REQUIRE(end > asked + 0.002);
    const std::string at = std::to_string((asked + end) / 2);
    bench.run("saving", {scenario, "--in-process", "--save-at", at, "--save", bench.folder() / "a.snap"});
    CHECK(bench.report("saving")["simulated_s"] == whole["simulated_s"]);
    CHECK(bench.report("saving")["trace_sha256"] == whole["trace_sha256"]);
}
