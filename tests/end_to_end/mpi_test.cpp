// puckloop-mpi under mpirun: the same run on several ranks of one machine.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <csignal>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

const std::string kScenarios = PUCKLOOP_SOURCE "/scenarios/";

/// mpirun with what it wants of a container's root and of more ranks than cores, on this machine alone.
Words mpirun(int ranks, const Words& words) {
    Words all{PUCKLOOP_MPIRUN};
    const Words options{"--allow-run-as-root",
                        "--oversubscribe",
                        "--bind-to",
                        "none",
                        "--mca",
                        "oob_tcp_if_include",
                        "lo",
                        "--mca",
                        "btl",
                        "vader,self"};
    all.insert(all.end(), options.begin(), options.end());
    all.insert(all.end(), {"-n", std::to_string(ranks)});
    all.insert(all.end(), words.begin(), words.end());
    return all;
}

Words job(int ranks, const Words& words) {
    Words all{PUCKLOOP_MPI_PROGRAM, "run"};
    all.insert(all.end(), words.begin(), words.end());
    return mpirun(ranks, all);
}

/// Some containers allow no MPI at all.
bool works(const Workbench& bench) {
    const Ended tried = Process(mpirun(2, {"true"}), bench.folder()).wait();
    if (tried.status != 0) WARN("skipped: mpirun does not work here: " << tried.err);
    return tried.status == 0;
}

Ended run_on(const Workbench& bench, int ranks, const std::string& out, Words words) {
    words.insert(words.end(), {"--out", bench.out(out).string()});
    return Process(job(ranks, words), bench.folder()).wait();
}

}  // namespace

TEST_CASE("a run on one, two and three ranks is the run in one process") {
    const Workbench bench;
    if (!works(bench)) return;
    const std::string scenario = kScenarios + "rab_pair.toml";
    REQUIRE(bench.run("here", {scenario, "--duration", "0.4", "--in-process"}).status == 0);
    for (const int ranks : {1, 2, 3}) {
        const std::string out = std::to_string(ranks);
        const Ended ended = run_on(bench, ranks, out, {scenario, "--duration", "0.4"});
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        check_same_run(bench, "here", out);
        if (ranks > 1) CHECK_THAT(ended.err, Contains(out + " ranks: "));
    }
}

TEST_CASE("a booth and its radio on another rank leave the same trace") {
    const Workbench bench;
    if (!works(bench)) return;
    const std::string scenario = kScenarios + "tam.toml";
    REQUIRE(bench.run("here", {scenario, "--duration", "1", "--in-process"}).status == 0);
    const Ended ended = run_on(bench, 2, "there", {scenario, "--duration", "1"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    check_same_run(bench, "here", "there");
}

TEST_CASE("on several ranks bad input is one line and status 2") {
    const Workbench bench;
    if (!works(bench)) return;
    const Ended missing = run_on(bench, 2, "o", {(bench.folder() / "none.toml").string()});
    CHECK(missing.status == 2);
    CHECK_THAT(missing.err, Contains("none.toml"));
    const auto [option, said] = GENERATE(table<Words, std::string>({
        {{"--view"}, "--view: does not go with nodes on several hosts"},
        {{"--in-process"}, "--in-process: does not go with nodes on several hosts"},
        {{"--gdb", "robot0.pic=unix:x"}, "--gdb: does not go with nodes on several hosts"},
        {{"--paced"}, "--paced: does not go with nodes on several hosts"},
    }));
    Words words{kScenarios + "hello.toml"};
    words.insert(words.end(), option.begin(), option.end());
    const Ended ended = run_on(bench, 2, "o", words);
    CHECK(ended.status == 2);
    CHECK_THAT(ended.err, Contains(said));
}

TEST_CASE("a node that cannot be made on its rank is named with the reason") {
    const Workbench bench;
    if (!works(bench)) return;
    const auto image = bench.file("broken.hex", ":00000001FF\n");
    const Ended ended = run_on(
        bench, 2, "o",
        {kScenarios + "hello.toml", "--duration", "0.1", "--firmware", "robot0.pic=" + image.string()});
    CHECK(ended.status == 2);
    CHECK_THAT(ended.err, Contains("broken.hex"));
}

TEST_CASE("a program that crashes on another rank ends the run as it does in one process") {
    const Workbench bench;
    if (!works(bench)) return;
    Words words{kScenarios + "hello.toml", "--duration", "2", "--linux", PUCKLOOP_MISBEHAVE, "crash"};
    const Ended apart = run_on(bench, 2, "there", words);
    words.insert(words.begin() + 1, "--in-process");
    const Ended alone = bench.run("here", words);
    CHECK(alone.status == 1);
    CHECK(apart.status == alone.status);
    CHECK(bench.report("there")["failure"] == bench.report("here")["failure"]);
    CHECK(bench.report("there")["trace_sha256"] == bench.report("here")["trace_sha256"]);
}

TEST_CASE("Ctrl-C at mpirun ends the run with a report") {
    const Workbench bench;
    if (!works(bench)) return;
    Words words{kScenarios + "hello.toml", "--out", bench.out("o").string(), "--duration", "1000 s"};
    Process process(job(2, words), bench.folder());
    while (!std::filesystem::exists(bench.out("o") / "trace.csv") && runs(process.id())) {
    }
    process.signal(SIGINT);
    CHECK(process.wait(60).status != 0);
    CHECK(bench.report("o")["ended_by"] == "interrupted");
}
