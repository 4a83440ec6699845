// What ps and top show of a run.

#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <set>
#include <thread>

using namespace puckloop::tests;

namespace {

/// Words of a process's command line, as ps shows them.
std::string command_line(pid_t process) {
    std::string text = text_of(fmt::format("/proc/{}/cmdline", process));
    for (char& c : text)
        if (c == '\0') c = ' ';
    while (text.ends_with(' '))
        text.pop_back();
    return text;
}

std::string short_name(pid_t process, pid_t thread) {
    std::string text = text_of(fmt::format("/proc/{}/task/{}/comm", process, thread));
    if (text.ends_with('\n')) text.pop_back();
    return text;
}

}  // namespace

TEST_CASE("each node's process and its threads carry the node's name") {
    const Workbench bench;
    const auto run = bench.start({"run", PUCKLOOP_SOURCE "/scenarios/hello.toml", "--realtime", "--duration",
                                  "600", "--out", bench.out("o")});
    const double begun = wall_seconds();
    while (text_of(bench.out("o") / "trajectory.csv").size() < 200 && wall_seconds() - begun < 60)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    std::set<std::string> lines, names;
    for (const pid_t child : run->children()) {
        lines.insert(command_line(child));
        for (const auto& task : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", child)))
            names.insert(short_name(child, std::stoi(task.path().filename())));
    }
    run->signal(SIGINT);
    run->wait();
    CHECK(lines == std::set<std::string>{"puckloop: robot0.i2c", "puckloop: robot0.linux",
                                         "puckloop: robot0.pic", "puckloop: world"});
    CHECK(names == std::set<std::string>{"robot0.i2c", "robot0.linux", "robot0.pic", "world"});
}
