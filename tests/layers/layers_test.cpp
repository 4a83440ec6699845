// Folders depend downward only: what a file includes lies in its own folder or in one further up in this
// list. docs/architecture.md states what each folder is.

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace fs = std::filesystem;

namespace {

/// From the bottom to the top. A file belongs to the longest entry that begins its path.
const std::vector<std::string> kFolders = {
    "base",
    "base/files",
    "base/logs",
    "base/pages",
    "base/states",
    "base/text",
    "base/fields",
    "base/version",
    "base/relay",
    "cosim/core",
    "protocols/can",
    "protocols/infrared",
    "protocols/network",
    "protocols/radio",
    "protocols/serial",
    "cosim/faults/spec",
    "cosim/faults/kinds",
    "cosim/faults",
    "cosim/trace",
    "cosim/schedule",
    "cosim/remote",
    "cosim/remote/processes",
    "cosim/remote/mpi",
    "cosim/i2c",
    "cosim/can",
    "cosim/resume",
    "cosim",
    "emu/chip",
    "emu/chip/translate",
    "emu/assembly",
    "emu/image",
    "emu/dspic/devices",
    "emu/dspic/machine",
    "emu/dspic/machine/execute",
    "emu/dspic/assembler",
    "emu/dspic/walk",
    "emu/dspic/waits",
    "emu/dspic/fast",
    "emu/dspic/translate",
    "emu/dspic/core",
    "emu/dspic/peripherals",
    "emu/dspic/peripherals/timing",
    "emu/dspic/peripherals/can",
    "emu/dspic/peripherals/serial",
    "emu/dspic/layouts",
    "emu/dspic/judge",
    "emu/dspic/chip",
    "emu/avr/isa",
    "emu/avr/devices",
    "emu/avr/machine",
    "emu/avr/machine/execute",
    "emu/avr/assembler",
    "emu/avr/fast",
    "emu/avr/translate",
    "emu/avr/core",
    "emu/avr/peripherals",
    "emu/avr/peripherals/serial",
    "emu/avr/peripherals/timing",
    "emu/avr/chip",
    "emu/i2c_devices",
    "emu/air",
    "emu/radio",
    "emu/xbee",
    "emu/bluetooth",
    "emu/network",
    "emu/wifi",
    "emu/camera",
    "emu/board",
    "emu/pic",
    "emu/rab_board",
    "emu/tam_avr",
    "physics/description",
    "physics/dynamics",
    "physics/sensors",
    "physics/robot",
    "physics/world",
    "physics/events",
    "physics/tracker",
    "physics/camera",
    "physics/ir",
    "physics/ircom",
    "physics/node",
    "physics/render",
    "missions",
    "scenarios/argos",
    "scenarios/description",
    "scenarios/values",
    "scenarios/tables",
    "scenarios/reader/compose",
    "scenarios/reader/events",
    "scenarios/reader/faults",
    "scenarios/reader",
    "linuxboard/control",
    "linuxboard/coordinator",
    "linuxboard/coordinator/experiments",
    "linuxboard/coordinator/program",
    "linuxboard/record",
    "linuxboard/netmanager",
    "linuxboard/forward",
    "linuxboard/gate",
    "linuxboard/shim/wire",
    "linuxboard/shim/network",
    "linuxboard/shim/preload/host",
    "linuxboard/shim/preload/scheduler",
    "linuxboard/shim/preload/descriptors",
    "linuxboard/shim/preload/time",
    "linuxboard/shim/preload/waiting",
    "linuxboard/shim/preload/network",
    "linuxboard/shim/preload/machine",
    "linuxboard/shim/preload/files",
    "linuxboard/shim/preload/threads",
    "linuxboard/shim/preload/processes",
    "linuxboard/shim/preload/syscalls",
    "linuxboard/shim/preload",
    "linuxboard/shim",
    "linuxboard",
    "debug",
    "debug/gdb",
    "debug/profile",
    "ends",
    "traces",
    "traces/decoders",
    "traces/formats",
    "view/live",
    "view/recording",
    "view/events",
    "view",
    "view/server",
    "run/files",
    "run/mission",
    "run/chips",
    "run/description",
    "run/states",
    "run/control",
    "run/factory",
    "run/nodes",
    "run/plan",
    "run/snapshots",
    "run/report",
    "run/expectations",
    "run/past",
    "run/debugging",
    "run/driven",
    "run",
    "bench/bus",
    "bench/targets",
    "bench/upload",
    "bench",
    "bench/debugger",
    "replay",
    "campaigns/statistics",
    "campaigns/jobs",
    "campaigns",
    "reproductions/runs",
    "reproductions/density",
    "reproductions",
    "benchmark/measures",
    "benchmark/scenarios",
    "benchmark/speeds",
    "benchmark",
    "gap/stats",
    "gap/kinds",
    "gap/data",
    "gap/findings",
    "gap/residuals",
    "gap/clean",
    "gap/sync",
    "gap/validate",
    "gap/reading",
    "gap/importers",
    "gap/models",
    "gap/effects",
    "gap/evidence",
    "gap/fit",
    "gap/residual_model",
    "gap/diagnostics",
    "gap/fit_test",
    "gap/predictive",
    "gap/identify",
    "gap/extension",
    "gap/decide",
    "gap/verdict",
    "gap/next_experiment",
    "gap/overlay",
    "gap/pipeline",
    "gap/report",
    "gap/begin",
    "gap/mission",
    "selftest/plain",
    "selftest/benches",
    "selftest",
    "selftest/grammar",
    "selftest/described",
    "selftest/emulate",
    "tools/cli",
    "tools/files",
    "tools/shell",
    "tools/bench",
    "tools/campaigns",
    "tools/chips",
    "tools/gap",
    "tools/records",
    "tools/viewer",
    "tools",
};

/// Place of a file's folder in the list; -1 where it has none.
int rank_of(std::string_view path) {
    int best = -1;
    std::size_t longest = 0;
    for (std::size_t i = 0; i < kFolders.size(); ++i) {
        const std::string prefix = kFolders[i] + "/";
        if (path.starts_with(prefix) && prefix.size() > longest) {
            longest = prefix.size();
            best = static_cast<int>(i);
        }
    }
    return best;
}

std::vector<std::string> includes_of(const fs::path& file) {
    std::vector<std::string> found;
    std::ifstream in(file);
    constexpr std::string_view kStart = "#include \"";
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(kStart)) continue;
        line.erase(0, kStart.size());
        found.push_back(line.substr(0, line.find('"')));
    }
    return found;
}

}  // namespace

TEST_CASE("the analysis of measured data includes no tool") {
    const fs::path source = PUCKLOOP_SOURCE;
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(source / "gap")) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".h" && extension != ".cpp") continue;
        ++files;
        for (const std::string& included : includes_of(entry.path())) {
            INFO(entry.path() << " includes " << included);
            CHECK_FALSE(included.starts_with("tools/"));
            CHECK_FALSE(included.starts_with("tests/"));
        }
    }
    CHECK(files > 100);
}

TEST_CASE("folders depend downward only") {
    const fs::path source = PUCKLOOP_SOURCE;
    int files = 0;
    for (const char* top :
         {"base",       "protocols", "cosim",     "emu",           "physics",   "missions", "scenarios",
          "linuxboard", "debug",     "ends",      "gap",           "traces",    "view",     "run",
          "bench",      "replay",    "campaigns", "reproductions", "benchmark", "selftest", "tools"}) {
        for (const auto& entry : fs::recursive_directory_iterator(source / top)) {
            const std::string extension = entry.path().extension().string();
            if (extension != ".h" && extension != ".cpp") continue;
            const std::string path = fs::relative(entry.path(), source).generic_string();
            const int rank = rank_of(path);
            INFO(path << " is in no folder of the list");
            REQUIRE(rank >= 0);
            ++files;
            for (const std::string& included : includes_of(entry.path())) {
                CHECK_FALSE(included.starts_with("tests/"));
                INFO(path << " includes " << included);
                CHECK(rank_of(included) <= rank);
            }
        }
    }
    CHECK(files > 200);
}
