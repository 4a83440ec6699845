// Folders of runs: what is read of them, and what is refused.

#include "base/error.h"
#include "base/random.h"
#include "gap/mission/mission.h"
#include "gap/mission/track.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap::mission;
namespace fs = std::filesystem;

namespace {

void write(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << text;
}

/// A robot on a circle and one that stands, 10 frames a second.
std::string circle(double radius, double seconds, double speed) {
    std::string text = "t_s,robot,x_m,y_m,theta_rad\n";
    for (int i = 0; i <= static_cast<int>(seconds * 10); ++i) {
        const double t = i / 10.0, angle = t * speed / radius;
        text += fmt::format("{:.1f},a,{:.6f},{:.6f},{:.6f}\n", t, radius * std::cos(angle),
                            radius * std::sin(angle), angle + std::numbers::pi / 2);
        text += fmt::format("{:.1f},b,0,0,0\n", t);
    }
    return text;
}

fs::path folder_of(const std::string& name, const std::function<double(int, bool)>& speed, bool conditions) {
    const fs::path folder = puckloop::tests::scratch_path(name);
    std::string table = conditions ? "run,program,condition,score\n" : "run,program,score\n";
    int run = 1;
    for (const char* program : {"walk", "turn"})
        for (const bool changed : {false, true}) {
            if (changed && !conditions) continue;
            for (int i = 0; i < 6; ++i, ++run) {
                table += fmt::format("{},{},{}{}\n", run, program,
                                     conditions ? (changed ? "faster," : "as it is,") : "", 10 + i);
                write(folder / "runs" / std::to_string(run) / "trajectory.csv",
                      circle(0.3, 6, speed(i, changed)));
            }
        }
    write(folder / "results.csv", table);
    return folder;
}

}  // namespace

TEST_CASE("a track's numbers are those of the way that was driven") {
    const fs::path file = puckloop::tests::scratch_path("track.csv");
    write(file, circle(0.3, 10, 0.1));
    const auto ways = read_track(file);
    REQUIRE(ways.size() == 2);
    const Behaviour seen = behaviour_of(ways, file);
    const double chord = 2 * 0.3 * std::sin(0.5 * 0.1 / 0.3 / 2) / 0.5;
    CHECK(seen.speed == Approx(chord / 2).epsilon(1e-3));  // one of two stands
    CHECK(seen.turning == Approx(0.1 / 0.3 / 2).epsilon(1e-3));
    CHECK(seen.standing == Approx(0.5));
    CHECK(seen.nearest == Approx(0.3).epsilon(1e-3));
    CHECK(seen.crowd == Approx(0.15).epsilon(1e-3));
    CHECK(seen.cruise == Approx(chord).epsilon(1e-3));  // the one that drives
    CHECK(seen.veer == Approx(0.1 / 0.3).epsilon(1e-3));
    CHECK(seen.approach == Approx(0.3).epsilon(1e-3));
    CHECK(seen.crossing == Approx(chord / 2).epsilon(1e-3));
}

TEST_CASE("a robot that the tracker loses is left out where it is not seen") {
    const fs::path file = puckloop::tests::scratch_path("lost.csv");
    std::string text = "t_s,robot,x_m,y_m\n";
    for (int i = 0; i <= 100; ++i)
        if (i < 30 || i > 60) text += fmt::format("{:.1f},a,{:.4f},0\n", i / 10.0, i * 0.01);
    write(file, text);
    const Behaviour seen = behaviour_of(read_track(file), file);
    CHECK(seen.speed == Approx(0.1));
    CHECK(std::isnan(seen.turning));
    CHECK(std::isnan(seen.nearest));
}

TEST_CASE("a folder of measured runs and an experiment's give a verdict") {
    const auto steady = [](int i, bool changed) { return (changed ? 0.12 : 0.10) + 0.001 * i; };
    const auto faster = [](int i, bool) { return 0.12 + 0.001 * i; };
    const auto measured = read_mission_runs(folder_of("measured", faster, false));
    const auto simulated = read_mission_runs(folder_of("simulated", steady, true));
    CHECK(simulated.conditions == std::vector<std::string>{"as it is", "faster"});
    const MissionVerdict verdict = judge(measured, simulated, 1);
    CHECK(verdict.comparison.finding == Finding::Named);
    CHECK(verdict.effects == std::vector<std::string>{"faster"});
    CHECK(verdict.comparison.together.at(0).share == Approx(1.0).margin(0.1));
    CHECK(verdict_json(verdict) == verdict_json(judge(measured, simulated, 1)));
    CHECK_THAT(summary_of(verdict), Catch::Contains("faster"));
    // And nothing is said of runs that are alike.
    const auto alike = read_mission_runs(folder_of(
        "alike", [&](int i, bool) { return steady(5 - i, false); }, false));
    CHECK(judge(alike, simulated, 1).comparison.finding == Finding::Same);
}

TEST_CASE("what is wrong with a folder of runs is one line with its place") {
    const fs::path folder = puckloop::tests::scratch_path("bad");
    const auto refused = [&](const std::string& table, const std::string& words) {
        write(folder / "results.csv", table);
        CHECK_THROWS_WITH(read_mission_runs(folder), Catch::Contains(words));
    };
    CHECK_THROWS_WITH(read_mission_runs(folder), Catch::Contains("cannot be read"));
    refused("", "line 1");
    refused("program,score\n", "has no column run");
    refused("run,score\n", "has no column program");
    refused("run,program\n", "has no runs");
    refused("run,program\n1,walk\n", "line 2: run 1 has no track");
    refused("run,program\n../1,walk\n", "is a path");
    write(folder / "1.csv", circle(0.3, 5, 0.1));
    refused("run,program\n1,walk\n", "program walk has 1 run");
    refused("run,program,score\n1,walk,much\n", "line 2: score much is not a number");
    write(folder / "1.csv", "t_s,robot,x_m,y_m\n0,a,0,0\n0,a,1,0\n");
    refused("run,program\n1,walk\n", "line 3: the time of 'a' does not rise");
    write(folder / "1.csv", "t_s,robot,x_m,y_m\n0,a,nan,0\n");
    refused("run,program\n1,walk\n", "line 2: is not a row of a track");
    write(folder / "1.csv", "t_s,robot,x_m\n");
    refused("run,program\n1,walk\n", "has no column y_m");
    write(folder / "1.csv", circle(0.3, 1, 0.1));
    refused("run,program\n1,walk\n", "lasts 1 s");
}

TEST_CASE("mutated tables and tracks are read or refused, never worse") {
    const fs::path folder = puckloop::tests::scratch_path("fuzz");
    write(folder / "1.csv", circle(0.3, 3, 0.1));
    write(folder / "2.csv", circle(0.3, 3, 0.11));
    const std::string table = "run,program,condition,score,failed\n1,walk,,3,\n2,walk,,4,\n";
    const std::string track = circle(0.3, 3, 0.1);
    RandomStream random(43, "gap/mission/fuzz");
    for (int i = 0; i < 600; ++i) {
        std::string changed = i % 2 == 0 ? table : track;
        for (std::uint64_t k = 0; k <= random.below(4); ++k)
            changed[random.below(changed.size())] = static_cast<char>(random.below(256));
        write(folder / (i % 2 == 0 ? "results.csv" : "1.csv"), changed);
        try {
            read_mission_runs(folder);
        } catch (const InputError&) {
        }
        if (i % 2 == 1)
            write(folder / "1.csv", track);
        else
            write(folder / "results.csv", table);
    }
}
