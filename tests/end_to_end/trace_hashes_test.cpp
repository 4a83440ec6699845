// The shipped scenarios make the traces that they always made, however they are run: the hashes below were
// taken before nodes ran ahead of what is certain, with one thread in one process. A change of a model, of
// firmware or of a scenario changes them; a change of how runs are executed must not.

#include "cosim/conductor.h"
#include "run/factory/node_factory.h"
#include "run/setup.h"
#include "tests/end_to_end/kit/load.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <gnu/libc-version.h>

#include <cstdlib>
#include <string_view>

using namespace puckloop;
using namespace puckloop::tests;

namespace {

struct Known {
    const char* scenario;
    const char* seconds;
    const char* sha256;
};

// Programs of most start at 42 s: boards alone up to then, or a short while only where that is dear.
constexpr Known kKnown[] = {
    {"hello.toml", "5", "266c8a6dab88540b5befac0ed6b6889b7a0cf58dd9da64d41e3a8a498036f7a1"},
    {"own_binaries.toml", "43", "1c6b7558fc8e29823338fec229f0c037d6aa07db850fd5b582e79c542083f651"},
    {"own_rab.toml", "0.5", "2f6692dc4362cd58389d9c25f4cf0d2bf9b65c13f7602467f88c2979ea6c04e8"},
    {"rab_pair.toml", "1", "d42f273746b0b7c5fc756f61942a2d594c2a7a9fe546f4a0b16cb037172e6c42"},
    {"swarm.toml", "0.5", "78cf4b2ee1e3290b09a56765d8fa8bf4ba23b354d7ce6b6c28a475de031f37f3"},
    {"calibrate_ground.toml", "54", "5265569d6cec09b7290a0afdcd3bfdecf9847a904ef7ac9246e4a67484d3c0a4"},
    {"calibrate_light.toml", "43", "93e1dcbb627b081003a8b0c2188cd07879cb93f7e62f49bf99473cabf89b96c0"},
    {"calibrate_proximity.toml", "54", "fa9df6c81dfd0b631c5b20ac6c235186d7692cccf48eabd99383e6d1e26cf498"},
    {"calibrate_rab.toml", "0.5", "0cd1b26981d7f50c2084f536c0dbe8c807219bcf6b9f932925e38366f4446b34"},
};

// Robots, TAMs, their modules' mesh, cameras, infra-red words and a coordinator together. The TAMs' firmware
// is built where the test is: the hash is that of Debian's avr-gcc.
constexpr Known kTam = {"tam.toml", "20", "05c25d3198421df98b95cbd7b92567ed933d4c6505859e7044b44e8cf158f615"};

bool same_tam_firmware() {
#ifdef PUCKLOOP_AVR_GCC
    if (std::string_view(PUCKLOOP_AVR_GCC) == "5.4.0") return true;
#endif
    WARN("no TAM firmware, or one by another compiler than the hash was taken with: skipped");
    return false;
}

/// The world computes with the C library's sine and the like, whose last bit differs between versions and
/// between processors with and without fused multiply-add.
bool same_arithmetic() {
#ifdef __SANITIZE_ADDRESS__
    WARN("the control programs are instrumented and make calls of their own, which take time: skipped");
    return false;
#endif
#if defined(__x86_64__)
    if (__builtin_cpu_supports("fma") && std::string_view(gnu_get_libc_version()) == "2.36") return true;
#endif
    WARN("another C library or processor than the hashes were taken with: skipped");
    return false;
}

std::string path_of(const Known& known) {
    return std::string(PUCKLOOP_SOURCE "/scenarios/") + known.scenario;
}

void check_hash(const Known& known, Words ways) {
    const Workbench bench;
    Words words{path_of(known), "--duration", known.seconds, "--no-cache"};
    words.insert(words.end(), ways.begin(), ways.end());
    const Ended ended = bench.run("o", words);
    INFO(known.scenario << " " << (ways.empty() ? "a process per node" : ways.back()) << ": " << ended.err);
    // A program that the run's end keeps from starting makes it fail; the trace is there all the same.
    CHECK(bench.report("o")["trace_sha256"] == known.sha256);
}

/// In this process, in windows where the seed is even, or one per node, with grants cut at random.
std::string chopped(const Known& known, bool in_process, unsigned threads, std::uint64_t seed) {
    const Workbench bench;
    tools::RunRequest request;
    request.scenario = path_of(known);
    request.out = bench.out("o");
    request.duration = std::stod(known.seconds);
    request.in_process = in_process;
    std::filesystem::create_directories(request.out / "coordinator");
    const tools::RunSetup setup = tools::set_up(request);
    cosim::RunOptions options;
    options.duration = cosim::from_seconds(*request.duration);
    options.in_process = in_process;
    options.threads = threads;
    options.windows = in_process && seed % 2 == 0;
    options.seed = setup.scenario.seed;
    options.node_command = {PUCKLOOP_PROGRAM};
    options.chop_seed = seed;
    cosim::Conductor conductor(tools::node_specs(setup), setup.links, setup.scenario.faults, options,
                               tools::make_described);
    const cosim::Outcome outcome = conductor.run();
    INFO(outcome.text);
    CHECK(outcome.success);
    return outcome.trace_sha256;
}

}  // namespace

TEST_CASE("every shipped scenario makes the trace that it always made") {
    if (!same_arithmetic()) return;
    for (const Known& known : kKnown)
        check_hash(known, {"--in-process"});
}

TEST_CASE("the traces are those with any number of threads and with a process per node") {
    if (!same_arithmetic()) return;
    for (const Known& known : kKnown) {
        const std::string_view name = known.scenario;
        if (name != "hello.toml" && name != "rab_pair.toml" && name != "swarm.toml") continue;
        for (const char* threads : {"1", "2", "4"})
            check_hash(known, {"--in-process", "--threads", threads});
    }
    for (const Known& known : {kKnown[0], kKnown[2]})
        check_hash(known, {});
    const Load load(4);
    check_hash(kKnown[3], {"--in-process", "--threads", "2"});
    check_hash(kKnown[8], {});
}

TEST_CASE("the traces do not depend on how grants are cut") {
    if (!same_arithmetic()) return;
    ::setenv("PATH", (PUCKLOOP_CONTROL_FOLDER ":" + std::string(std::getenv("PATH"))).c_str(), 1);
    std::uint64_t seed = 1;
    for (const Known& known : {kKnown[0], kKnown[3]})
        for (const unsigned threads : {1U, 2U}) {
            INFO(known.scenario << ", chop seed " << seed << ", threads " << threads);
            CHECK(chopped(known, true, threads, seed++) == known.sha256);
        }
    INFO("a process per node, chop seed " << seed);
    CHECK(chopped(kKnown[0], false, 1, seed) == kKnown[0].sha256);
}

TEST_CASE("the trace of TAMs does not depend on placement, threads or cuts either") {
    if (!same_arithmetic() || !same_tam_firmware()) return;
    ::setenv("PATH", (PUCKLOOP_CONTROL_FOLDER ":" + std::string(std::getenv("PATH"))).c_str(), 1);
    for (const char* threads : {"1", "2", "4"})
        check_hash(kTam, {"--in-process", "--threads", threads});
    const Load load(2);
    check_hash(kTam, {});
    CHECK(chopped(kTam, true, 1, 11) == kTam.sha256);
    CHECK(chopped(kTam, true, 2, 12) == kTam.sha256);
}
