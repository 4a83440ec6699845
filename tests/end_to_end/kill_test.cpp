// kill -9 at any moment, of a node's process, of a Linux program, of the run itself: it ends at once, with
// the victim's name, and leaves nothing but what it recorded. PUCKLOOP_KILLS sets how many (12).

#include "base/random.h"
#include "tests/end_to_end/kit/one_line.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <thread>

using namespace puckloop::tests;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

constexpr const char* kMark = "PUCKLOOP_KILL_TEST";
constexpr double kSoon = 3.0;
const std::string kNodeTitle = "puckloop: ";

int kills() {
    const char* const asked = std::getenv("PUCKLOOP_KILLS");
    return asked ? std::atoi(asked) : 12;
}

/// Processes that have `mark` in their environment, with their command lines.
std::map<pid_t, std::string> family(const std::string& mark) {
    std::map<pid_t, std::string> found;
    std::error_code gone;
    for (const auto& entry : fs::directory_iterator("/proc", gone)) {
        const pid_t id = std::atoi(entry.path().filename().c_str());
        if (id == 0 || id == getpid() || text_of(entry.path() / "environ").find(mark) == std::string::npos)
            continue;
        std::string line = text_of(entry.path() / "cmdline");
        std::replace(line.begin(), line.end(), '\0', ' ');
        if (runs(id)) found[id] = line;
    }
    return found;
}

/// A scenario of the project as text. The program of hello.toml is done after a simulated minute, which on a
/// fast machine is less than a second: here it goes on.
std::string lasting(const std::string& scenario) {
    const std::string folder = PUCKLOOP_SOURCE "/";
    std::string text = text_of(folder + "scenarios/" + scenario);
    const auto replace = [&text](const std::string& what, const std::string& by) {
        for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
            text.replace(at, what.size(), by);
    };
    replace("\"../", "\"" + folder);
    replace("\"--duration\", \"60\"", "\"--duration\", \"36000\"");
    return text;
}

/// What stands in /dev/shm under the project's name.
std::set<std::string> shared_files() {
    std::set<std::string> names;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator("/dev/shm", none))
        if (const std::string name = entry.path().filename(); name.find("puckloop") != std::string::npos)
            names.insert(name);
    return names;
}

/// One run, killed somewhere. `pick` chooses among its processes; 0: not there yet.
struct KilledRun {
    Workbench bench;
    std::string mark;
    pid_t victim = 0;
    std::string victim_line;
    Ended ended;
    double seconds = 0;  ///< from the kill to the end

    KilledRun(int number, const std::string& scenario, const Words& words, double moment_s,
              const std::function<pid_t(const std::map<pid_t, std::string>&, pid_t)>& pick) {
        mark = fmt::format("{}={}.{}.", kMark, getpid(), number);
        setenv(kMark, mark.c_str() + std::string(kMark).size() + 1, 1);
        Words all{"run", bench.file(scenario, lasting(scenario))};
        all.insert(all.end(), words.begin(), words.end());
        all.insert(all.end(), {"--duration", "36000", "--out", bench.out("o")});
        const auto process = bench.start(all);
        unsetenv(kMark);
        std::this_thread::sleep_for(std::chrono::duration<double>(moment_s));
        for (const double begun = wall_seconds();
             victim == 0 && runs(process->id()) && wall_seconds() - begun < 60.0;) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            const auto processes = family(mark);
            victim = pick(processes, process->id());
            if (!processes.contains(victim))
                victim = 0;
            else
                victim_line = processes.at(victim);
        }
        const double before = wall_seconds();
        if (victim != 0) ::kill(victim, SIGKILL);
        ended = process->wait();
        seconds = wall_seconds() - before;
    }

    void check(int status) const {
        REQUIRE(victim != 0);
        CHECK(ended.status == status);
        CHECK(seconds < kSoon);
        // The kernel ends the last ones after the run itself, if that was the victim.
        for (const double begun = wall_seconds(); !family(mark).empty() && wall_seconds() - begun < kSoon;)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        CHECK(family(mark).empty());
    }

    /// What was recorded can be read, every row of it; a run that had not begun has recorded nothing.
    void check_recorded() const {
        if (!fs::exists(bench.out("o") / "trace.csv")) return;
        CHECK(bench.report("o")["ended_by"] != "duration");
        for (const Row& row : bench.csv("o", "trace.csv"))
            REQUIRE(std::stod(row.at("time_s")) >= 0);
        CHECK(!fs::exists(bench.out("o") / "report.json.part"));
    }
};

bool is_node(const std::string& line) {
    return line.starts_with(kNodeTitle);
}

bool is_program(const std::string& line) {
    return !is_node(line) && line.find("--behaviour") != std::string::npos;
}

}  // namespace

TEST_CASE("node processes killed at random moments are named, and nothing is left", "[kill]") {
    puckloop::RandomStream random(20261123, "node processes");
    const auto before = shared_files();
    for (int k = 0; k < (kills() + 1) / 2; ++k) {
        const std::string scenario = random.below(3) == 0 ? "rab_pair.toml" : "hello.toml";
        const double moment = random.uniform();
        const std::uint64_t choice = random.next();
        const KilledRun run(k, scenario, {}, moment, [&](const auto& processes, pid_t) {
            std::vector<pid_t> nodes;
            for (const auto& [id, line] : processes)
                if (is_node(line)) nodes.push_back(id);
            return nodes.empty() ? 0 : nodes[choice % nodes.size()];
        });
        const std::string name = run.victim_line.substr(kNodeTitle.size());
        INFO(fmt::format("kill {}: {} of {} after {:.3f} s: {}", k, name, scenario, moment, run.ended.err));
        run.check(1);
        check_one_line(run.ended, 1, {"node " + name.substr(0, name.find(' '))});
        run.check_recorded();
    }
    CHECK(shared_files() == before);
}

TEST_CASE("Linux programs killed at random moments are named in both placements", "[kill]") {
    puckloop::RandomStream random(20261123, "programs");
    const auto before = shared_files();
    for (int k = 0; k < (kills() + 2) / 3; ++k) {
        Words words;
        if (k % 2 == 0) words.push_back("--in-process");
        const double moment = random.uniform();
        const KilledRun run(1000 + k, "hello.toml", words, moment, [](const auto& processes, pid_t) {
            const auto program = std::find_if(processes.begin(), processes.end(),
                                              [](const auto& entry) { return is_program(entry.second); });
            return program == processes.end() ? 0 : program->first;
        });
        INFO(fmt::format("kill {} after {:.3f} s: {}", k, moment, run.ended.err));
        run.check(1);
        check_one_line(run.ended, 1, {"node robot0.linux", "puckloop-control", "SIGKILL"});
        run.check_recorded();
    }
    CHECK(shared_files() == before);
}

TEST_CASE("a run killed at random moments takes all its processes along", "[kill]") {
    puckloop::RandomStream random(20261123, "runs");
    const auto before = shared_files();
    for (int k = 0; k < (kills() + 5) / 6; ++k) {
        Words words;
        if (k % 2 != 0) words.push_back("--in-process");
        const double moment = random.uniform();
        const KilledRun run(2000 + k, "hello.toml", words, moment,
                            [](const auto&, pid_t itself) { return itself; });
        INFO(fmt::format("kill {} after {:.3f} s", k, moment));
        run.check(128 + SIGKILL);
    }
    CHECK(shared_files() == before);
}
