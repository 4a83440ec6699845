// Folders depend downward only: what a file includes lies in its own folder or in one further up in this
// list. docs/architecture.md states what each folder is.

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace fs = std::filesystem;

namespace {

/// From the bottom to the top. A file belongs to the longest entry that begins its path.
const std::vector<std::string> kFolders = {
    "base",
    "base/fields",
    "base/version",
    "cosim/core",
    "protocols",
    "cosim/faults",
    "cosim/trace",
    "cosim/schedule",
    "cosim/remote",
    "cosim/i2c",
    "cosim/can",
    "cosim/resume",
    "cosim",
    "emu/chip",
    "emu/assembly",
    "emu/image",
    "emu/dspic/devices",
    "emu/dspic/core",
    "emu/dspic/assembler",
    "emu/dspic/fast",
    "emu/dspic/translate",
    "emu/dspic/peripherals",
    "emu/dspic/waits",
    "emu/dspic/chip",
    "emu/avr",
    "emu/i2c_devices",
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
    "scenarios",
    "linuxboard/control",
    "linuxboard/coordinator",
    "linuxboard/record",
    "linuxboard/netmanager",
    "linuxboard/forward",
    "linuxboard/shim/wire",
    "linuxboard/shim/network",
    "linuxboard/shim",
    "linuxboard",
    "debug",
    "ends",
    "traces",
    "view",
    "run/files",
    "run/mission",
    "run/description",
    "run/stats",
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
    "reproductions",
    "benchmark",
    "gap",
    "selftest",
    "selftest/grammar",
    "selftest/emulate",
    "tools/cli",
    "tools",
};

/// Includes that go up, each with its reason. One that is no longer there has to leave this list.
const std::set<std::string> kUpward = {
    // The machine holds the state of what watches, shortens and translates its loops; Core makes and saves
    // it.
    "emu/dspic/core/machine.h emu/dspic/fast/isr_path.h",
    "emu/dspic/core/machine.h emu/dspic/fast/isr_summary.h",
    "emu/dspic/core/machine.h emu/dspic/translate/translation.h",
    "emu/dspic/core/machine.h emu/dspic/waits/wait_watch.h",
    "emu/dspic/core/core.h emu/dspic/waits/wait_watch.h",
    "emu/dspic/core/core.cpp emu/dspic/fast/loop_undo.h",
    "emu/dspic/core/core.cpp emu/dspic/fast/idle_loops.h",
    "emu/dspic/core/core_archive.cpp emu/dspic/fast/loop_undo.h",
    // The run loop goes on inside a loop in which the machine is.
    "emu/dspic/core/core_run.cpp emu/dspic/fast/idle_loops.h",
    // Judging a wait asks which modules could end it.
    "emu/dspic/waits/judge.h emu/dspic/chip/layout.h",
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
    std::set<std::string> upward;
    int files = 0;
    for (const char* top :
         {"base",       "protocols", "cosim",         "emu",       "physics",  "missions", "scenarios",
          "linuxboard", "debug",     "ends",          "traces",    "view",     "run",      "bench",
          "replay",     "campaigns", "reproductions", "benchmark", "selftest", "tools"}) {
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
                if (rank_of(included) > rank) upward.insert(path + " " + included);
            }
        }
    }
    CHECK(files > 200);
    for (const std::string& pair : upward) {
        INFO("upward: " << pair);
        CHECK(kUpward.contains(pair));
    }
    for (const std::string& pair : kUpward) {
        INFO("no longer there, take it off the list: " << pair);
        CHECK(upward.contains(pair));
    }
}
