#include "benchmark/cases.h"

#include "base/error.h"
#include "benchmark/case_kit.h"
#include "benchmark/scenarios/rab_scenario.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>

namespace puckloop::tools {

namespace {

// Shares of the scenario's duration that dearer runs take.
constexpr double kSwarmShare = 0.2, kWanderShare = 0.25, kMemoryShare = 0.15;

void hello(Kit& kit) {
    const BenchOptions& options = kit.options();
    const auto scenario = options.scenario.empty() ? kit.shipped("hello.toml") : options.scenario;
    const std::string name = scenario.filename().string();
    kit.time_runs(name + ", one process", {scenario, options.simulated_s, true, options.threads});
    kit.time_runs(name + ", one process per node", {scenario, options.simulated_s, false});
}

void swarm(Kit& kit) {
    const BenchOptions& options = kit.options();
    kit.time_runs("swarm.toml, one process",
                  {kit.shipped("swarm.toml"), kSwarmShare * options.simulated_s, true, options.threads});
}

void overhead(Kit& kit) {
    kit.time_overhead("hello.toml", kit.shipped("hello.toml"), kit.options().simulated_s);
    kit.time_overhead("swarm.toml", kit.shipped("swarm.toml"), kSwarmShare * kit.options().simulated_s);
}

void wander(Kit& kit) {
    kit.time_growth(kWanderShare * kit.options().simulated_s);
}

void memory(Kit& kit) {
    kit.weigh(kMemoryShare * kit.options().simulated_s);
}

void rab(Kit& kit, int robots) {
    const BenchOptions& options = kit.options();
    const auto scenario =
        write_rab_scenario(kit.folder() / "scenario", robots, kit.main_image(), kit.rab_image());
    kit.time_runs(fmt::format("rab{}, one process", robots),
                  {scenario, kSwarmShare * options.simulated_s, true, options.threads});
}

/// A laboratory of TAMs with their coordinator: the project's firmware, and the real one where it is there.
void tams18(Kit& kit) {
    const BenchOptions& options = kit.options();
    RunSpec spec{kit.shipped("tams18.toml"), options.simulated_s, true, options.threads};
    kit.time_runs("tams18.toml, one process", spec);
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    if (folder == nullptr) return;
    const auto image = std::filesystem::path(folder) / "tam_firmware.elf";
    if (!std::filesystem::exists(image)) return;
    spec.options = {"--firmware", "tam=" + image.string()};
    kit.time_runs("tams18.toml, tam_firmware.elf, one process", spec);
}

struct Case {
    std::string name;
    std::string what;  ///< one line of help
    std::function<void(Kit&)> measure;
};

const std::vector<Case>& table() {
    static const std::vector<Case> cases{
        {"core", "a compute loop on the bare core, and --image", [](Kit& kit) { kit.time_core(); }},
        {"avr", "the ATmega1284P beside libsimavr on the same ELFs", [](Kit& kit) { kit.time_avr(); }},
        {"board", "one range-and-bearing board alone, and marks of both dsPIC boards",
         [](Kit& kit) { kit.time_boards(); }},
        {"scenario", "--scenario in one process and with one process per node", hello},
        {"swarm", "swarm.toml in one process", swarm},
        {"overhead", "hello.toml and swarm.toml beside their boards alone", overhead},
        {"wander", "--robots robots that wander, in one process", wander},
        {"world", "the physical world alone, part by part", [](Kit& kit) { kit.time_world(); }},
        {"wait", "main boards whose firmware waits for a partner that is silent, by exec",
         [](Kit& kit) { kit.time_waiting(); }},
        {"memory", "resident memory of the runs of wander", memory},
        {"rab1", "a robot with a busy range-and-bearing board", [](Kit& kit) { rab(kit, 1); }},
        {"rab2", "two of them", [](Kit& kit) { rab(kit, 2); }},
        {"rab8", "eight of them", [](Kit& kit) { rab(kit, 8); }},
        {"lab20", "twenty robots of a laboratory, and what their cost is made of",
         [](Kit& kit) { kit.time_lab20(); }},
        {"tams18", "tams18.toml, eighteen TAMs with radio mesh and coordinator, in one process", tams18}};
    return cases;
}

}  // namespace

const std::vector<std::string>& bench_cases() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        for (const Case& one : table())
            list.push_back(one.name);
        return list;
    }();
    return names;
}

std::string bench_cases_help() {
    std::string text;
    for (const Case& one : table())
        text += fmt::format("\n{:<8}  {}", one.name, one.what);
    return text;
}

std::vector<Figure> measure_cases(const BenchOptions& options) {
    if (!options.peer.empty() && ::access(options.peer.c_str(), X_OK) != 0)
        throw InputError(options.peer.string(), "--peer", "cannot be run", "a build of puckloop");
    Kit kit(options);
    for (const std::string& name : options.cases)
        for (const Case& one : table())
            if (one.name == name) one.measure(kit);
    return kit.take_figures();
}

}  // namespace puckloop::tools
