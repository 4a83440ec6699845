// Outcomes of made-up runs whose fault, time and size are drawn.

#include "base/random.h"
#include "campaigns/engine/findings.h"
#include "campaigns/engine/outcome.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

using namespace puckloop;
using namespace puckloop::faults;
using nlohmann::json;

namespace {

constexpr const char* kBoard = "r.uart from r.pic";
constexpr const char* kProgram = "r.uart from r.linux";

/// Ten seconds, a record of each end every 100 ms, the robot drives 5 cm/s.
Profile nominal_run() {
    Profile run;
    run.report = {{"success", true},
                  {"simulated_s", 10.2},
                  {"programs_asked_to_end_s", 10.0},
                  {"ended_why", ""},
                  {"trace_sha256", "00"},
                  {"faults", json::array()},
                  {"nodes", {{"r.pic", {{"resets", {1}}, {"steps", 4000}}}}}};
    for (int i = 0; i < 100; ++i) {
        const double time = 0.05 + 0.1 * i;
        for (const char* sender : {kBoard, kProgram}) {
            run.senders[sender].times.push_back(time);
            run.senders[sender].values.push_back("00");
            run.senders[sender].frame_s.push_back(0);
        }
        run.paths["r"][fmt::format("{:.3f}", time)] = {0.05 * time, 0};
    }
    run.log_shapes = {"r.linux: started at # s"};
    run.error_counters = {{"nodes.r.pic.uart2.overruns", 0}};
    return run;
}

void cut_times(Profile& run, const char* sender, double from, double to) {
    auto& times = run.senders[sender].times;
    std::erase_if(times, [&](double time) { return time >= from && time < to; });
}

Campaign campaign_of() {
    Campaign campaign;
    campaign.metrics = {{"path", "r", "", 0.1, true}, {"steps", "", "/nodes/r.pic/steps", 50, false}};
    return campaign;
}

void fire(Profile& run, double time) {
    run.report["faults"] = {{{"fault", "drop"}, {"fired", 1}}};
    run.first_fault_s = time;
}

}  // namespace

TEST_CASE("a metric counts the lines of a program's log that hold its text") {
    Campaign campaign = campaign_of();
    Metric tasks;
    tasks.name = "tasks";
    tasks.log = "c.linux";
    tasks.lines = "task done";
    campaign.metrics = {tasks};
    Profile nominal = nominal_run();
    CHECK_FALSE(measure(tasks, nominal));
    nominal.logs["c.linux"] = {"[1 s] task done blue", "[2 s] task aborted", "[3 s] task done green"};
    CHECK(measure(tasks, nominal) == 2.0);
    Profile run = nominal;
    fire(run, 2.0);
    CHECK(judge(campaign, nominal, run, 1).outcome == Outcome::Masked);
    run.logs["c.linux"].pop_back();
    const Verdict verdict = judge(campaign, nominal, run, 1);
    CHECK(verdict.outcome == Outcome::Degraded);
    CHECK(verdict.metrics[0].second == 1.0);
}

TEST_CASE("each outcome is the one of its definition, wherever the fault strikes") {
    RandomStream random(GENERATE(11, 12, 13, 14, 15, 16), "outcomes");
    const Campaign campaign = campaign_of();
    const Profile nominal = nominal_run();
    const double at = 1 + 6 * random.uniform();
    CAPTURE(at);
    Profile run = nominal;
    fire(run, at);
    const auto outcome = [&] { return judge(campaign, nominal, run, 1).outcome; };

    SECTION("masked") {
        // A robot that is elsewhere by less than the limit is where it was.
        for (auto& [time, pose] : run.paths["r"])
            pose.y += 0.9 * campaign.limits.departure * random.uniform();
        for (auto& [time, pose] : run.paths["r"])
            pose.y = 0.9 * campaign.limits.departure;
        CHECK(outcome() == Outcome::Masked);
    }
    SECTION("not fired, whatever else") {
        run.report["faults"][0]["fired"] = 0;
        cut_times(run, kBoard, at, 20);
        CHECK(outcome() == Outcome::NotFired);
    }
    SECTION("puckloop failed, whatever else: the emulator itself broke off") {
        run.report["success"] = false;
        run.report["ended_by"] = "failed";
        run.report["ended_why"] = "node t0.xbee sent before its earliest output time at 3.570800000000 s";
        run.report["faults"][0]["fired"] = random.below(2);
        cut_times(run, kBoard, at, 20);
        const Verdict verdict = judge(campaign, nominal, run, 1);
        CHECK(verdict.outcome == Outcome::PuckloopFailed);
        CHECK(is_finding(verdict.outcome));
        CHECK(verdict.symptoms.at(0) == "node t#.xbee sent before its earliest output time at # s");
        CHECK_THAT(verdict.detail, Catch::Contains("3.5708"));
        CHECK(verdict.trace_sha256.empty());
    }
    SECTION("a node that stalls simulated time is a hang, though the run broke off") {
        run.report["success"] = false;
        run.report["ended_by"] = "failed";
        run.report["ended_why"] = "node r.linux: has not let time pass for 30 s of wall clock";
        CHECK(outcome() == Outcome::Hang);
    }
    SECTION("crash") {
        run.report["success"] = false;
        run.report["ended_why"] = "node r.linux: /some/where/control: ended by SIGSEGV";
        cut_times(run, kProgram, at, 20);
        const Verdict verdict = judge(campaign, nominal, run, 1);
        CHECK(verdict.outcome == Outcome::Crash);
        // The same wherever the program lies.
        CHECK(verdict.symptoms.at(0) == "node r.linux: control: ended by SIGSEGV");
    }
    SECTION("a program that computes for ever hangs and does not crash") {
        run.report["success"] = false;
        run.report["ended_why"] = "node r.linux: has not let time pass for 30 s of wall clock";
        CHECK(outcome() == Outcome::Hang);
    }
    SECTION("reset loop") {
        run.report["nodes"]["r.pic"]["resets"] = json::array({1, 2, 3});
        CHECK(outcome() == Outcome::Masked);
        run.report["nodes"]["r.pic"]["resets"] = json::array({1, 2, 3, 4});
        CHECK(outcome() == Outcome::ResetLoop);
    }
    SECTION("hang, of either end") {
        const char* who = random.below(2) == 0 ? kBoard : kProgram;
        cut_times(run, who, at, 20);
        const Verdict verdict = judge(campaign, nominal, run, 1);
        CHECK(verdict.outcome == Outcome::Hang);
        CHECK(verdict.symptoms.at(0) == std::string(who) + " falls silent");
        CHECK(!verdict.recovery_s);
    }
    SECTION("a program that ends itself early, with status 0, hangs") {
        const double ended = at + 0.5;
        run.report["simulated_s"] = ended;
        run.report["programs_asked_to_end_s"] = nullptr;
        for (const char* who : {kBoard, kProgram})
            cut_times(run, who, ended, 20);
        const Verdict verdict = judge(campaign, nominal, run, 1);
        CHECK(verdict.outcome == Outcome::Hang);
        CHECK(verdict.symptoms.at(0) == "the run ends early");
    }
    SECTION("recovered, with its time") {
        const double silent = 0.3 + 0.5 * random.uniform();
        cut_times(run, kBoard, at, at + silent);
        const Verdict verdict = judge(campaign, nominal, run, 1);
        CHECK(verdict.outcome == Outcome::Recovered);
        REQUIRE(verdict.recovery_s);
        CHECK(*verdict.recovery_s >= silent - 1e-9);
        CHECK(*verdict.recovery_s <= silent + 0.1 + 1e-9);
    }
    SECTION("a pause that nominal runs have, too, is none") {
        Profile slow = nominal;
        cut_times(slow, kBoard, 3, 4);
        run.senders = slow.senders;
        CHECK(judge(campaign, slow, run, 1).outcome == Outcome::Masked);
    }
    SECTION("degraded: the path, or a number of the report") {
        if (random.below(2) == 0) {
            for (auto& [time, pose] : run.paths["r"])
                pose.x *= 0.85;
        } else {
            run.report["nodes"]["r.pic"]["steps"] = 4000 + 51 * (random.below(2) == 0 ? 1 : -1);
        }
        CHECK(outcome() == Outcome::Degraded);
    }
    SECTION("detected: by a counter, or by a line that is new but for its numbers") {
        if (random.below(2) == 0)
            run.error_counters["nodes.r.pic.uart2.overruns"] = 1;
        else
            run.log_shapes.insert("r.linux: " + shape_of("\x1b[1;31mlost 3 bytes at 4.5 s\x1b[0m"));
        for (auto& [time, pose] : run.paths["r"])
            pose.y = 2 * campaign.limits.departure;
        CHECK(outcome() == Outcome::Detected);
        run = nominal;
        fire(run, at);
        run.log_shapes.insert("r.linux: " + shape_of("started at 17.3 s"));
        CHECK(outcome() == Outcome::Masked);
    }
    SECTION("silent corruption") {
        const auto last = std::prev(run.paths["r"].end());
        last->second.y += (1.1 + random.uniform()) * campaign.limits.departure;
        const Verdict verdict = judge(campaign, nominal, run, 1);
        CHECK(verdict.outcome == Outcome::SilentCorruption);
        CHECK(verdict.departure_m > campaign.limits.departure);
        CHECK(to_json(verdict_from_json(json::parse(to_json(verdict).dump()))) == to_json(verdict));
    }
}

TEST_CASE("what a fault puts on a line is no sign of life") {
    const auto folder = tests::scratch_path("puckloop-profile");
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "report.json") << R"({"success": true, "nodes": {}})";
    std::ofstream trace(folder / "trace.csv");
    trace << "time_s,link,from,kind,value,detail,start_s,period_s,stretch_s,fault\n";
    for (const char* fault : {"", "drop", "break", "false_start", "loopback", "late"})
        trace << "1.5,r.uart,r.pic,uart,41,8N1,1.4,0.00001,," << fault << "\n";
    trace.close();
    const Profile profile = read_profile(folder);
    std::filesystem::remove_all(folder);
    REQUIRE(profile.senders.contains(kBoard));
    CHECK(profile.senders.at(kBoard).times == std::vector<double>{1.4, 1.4, 1.4});
    CHECK(profile.first_fault_s == 1.4);
}

TEST_CASE("a robot whose wheels turn after the last command is one that drives on blindly") {
    RandomStream random(GENERATE(1, 2, 3), "blind");
    const Campaign campaign = campaign_of();
    Profile nominal = nominal_run();
    for (int i = 0; i < 1000; ++i)
        nominal.turns["r"].push_back(0.01 * i);
    const double at = 2 + 4 * random.uniform();
    Profile run = nominal;
    fire(run, at);
    cut_times(run, kProgram, at, 20);
    const double last = run.senders[kProgram].times.back();
    const auto blind = [&] {
        const Verdict verdict = judge(campaign, nominal, run, 1);
        const auto found = std::find(verdict.symptoms.begin(), verdict.symptoms.end(),
                                     "wheels of r turned after the last command");
        return std::pair(found != verdict.symptoms.end(), verdict.detail);
    };
    SECTION("to the end") {
        CHECK(judge(campaign, nominal, run, 1).outcome == Outcome::Hang);
        const auto [found, detail] = blind();
        CHECK(found);
        CHECK_THAT(detail, Catch::Contains(fmt::format("(for {:.3f} s)", 9.99 - last)));
    }
    SECTION("until commands come again") {
        run.senders[kProgram].times.push_back(9.5);
        CHECK(judge(campaign, nominal, run, 1).outcome == Outcome::Recovered);
        const auto [found, detail] = blind();
        CHECK(found);
        CHECK_THAT(detail, Catch::Contains("wheels of r turned after the last command (for "));
        CHECK_THAT(detail, !Catch::Contains(fmt::format("(for {:.3f} s)", 9.99 - last)));
    }
    SECTION("not if they stop soon") {
        std::erase_if(run.turns["r"],
                      [&](double time) { return time > last + 0.9 * campaign.limits.silence; });
        CHECK_FALSE(blind().first);
    }
    SECTION("what another robot's program sends is no command") {
        run.senders["q.uart from q.linux"] = nominal.senders[kProgram];
        CHECK(blind().first);
    }
}

TEST_CASE("wheels' steps are read from the trace") {
    const auto folder = tests::scratch_path("puckloop-profile-wheels");
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "report.json") << R"({"success": true, "nodes": {}})";
    std::ofstream(folder / "trace.csv")
        << "time_s,link,from,kind,value,detail,start_s,period_s,stretch_s,fault\n"
           "1.5,r.world,r.pic,signal,7,wheel_left,,,,\n"
           "1.6,r.world,r.pic,signal,1,led0,,,,\n"
           "1.7,r.world,r.pic,signal,-3,wheel_right,,,,\n";
    const Profile profile = read_profile(folder);
    std::filesystem::remove_all(folder);
    CHECK(profile.turns.at("r") == std::vector<double>{1.5, 1.7});
    CHECK(profile.senders.empty());
}

TEST_CASE("what fell silent first is the cause, whatever the fault") {
    const Campaign campaign = campaign_of();
    const Profile nominal = nominal_run();
    std::vector<CaseResult> results;
    for (const bool board_first : {true, false, true})
        for (const char* kind : {"drop", "flip"}) {
            Profile run = nominal;
            fire(run, 2.0);
            cut_times(run, kBoard, board_first ? 3.0 : 5.0, 20);
            cut_times(run, kProgram, board_first ? 4.0 : 3.0, 20);
            CaseResult result;
            result.one.id = static_cast<int>(results.size()) + 1;
            result.one.faults = {{{"kind", kind}, {"link", "r.uart"}}};
            result.verdict = judge(campaign, nominal, run, 1);
            results.push_back(result);
        }
    const std::vector<Finding> findings = findings_of(results);
    CHECK(findings.size() == 4);
    const std::vector<Cause> causes = causes_of(findings);
    REQUIRE(causes.size() == 2);
    CHECK(causes[0].what == "r.uart from r.linux falls silent");
    CHECK(causes[0].findings.size() == 2);
    CHECK(causes[0].cases == 2);
    CHECK(causes[1].what == "r.uart from r.pic falls silent");
    CHECK(causes[1].cases == 4);
}

TEST_CASE("a finding is shown by its smallest case") {
    RandomStream random(GENERATE(1, 2, 3), "findings");
    std::vector<CaseResult> results;
    const std::size_t smallest = random.below(20);
    for (std::size_t i = 0; i < 20; ++i) {
        CaseResult result;
        result.one.id = static_cast<int>(i) + 1;
        result.one.faults = {{{"kind", "drop"}, {"link", "r.uart"}}};
        result.verdict.outcome = Outcome::Hang;
        result.verdict.fired = {i == smallest ? 2 : 3 + random.below(9)};
        result.verdict.symptoms = {"r falls silent", fmt::format("log of r: line {}", i)};
        results.push_back(result);
    }
    results.push_back(results.back());
    results.back().one.id = 21;
    results.back().verdict.outcome = Outcome::Masked;
    const std::vector<Finding> findings = findings_of(results);
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].cases.size() == 20);
    CHECK(findings[0].smallest->one.id == static_cast<int>(smallest) + 1);
    CHECK(findings[0].faults == "drop on r.uart");
}
