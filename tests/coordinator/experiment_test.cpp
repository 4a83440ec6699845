// The experiments against a simulated set of TAMs, in simulated time: robots come and go at random, radio
// packets are lost, and what the event table states is checked against rules that know nothing of the
// controllers.

#include "linuxboard/coordinator/coordinator.h"
#include "linuxboard/coordinator/experiments/experiments.h"
#include "linuxboard/coordinator/gantt.h"
#include "tests/coordinator/virtual_line.h"
#include "tests/coordinator/visits.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>
#include <fstream>
#include <map>
#include <set>

using namespace puckloop;
using namespace puckloop::coordinator;
using namespace puckloop::coordinator::test;

namespace {

struct Outcome {
    std::vector<Event> events;
    std::map<std::string, SimulatedTam> tams;
    std::vector<std::string> commands;
    int bad_frames = 0;
    double end = 0;
    std::vector<Event> of(const std::string& tam, const std::string& event) const {
        std::vector<Event> found;
        for (const Event& e : events)
            if (e.tam == tam && (event.empty() || e.event == event)) found.push_back(e);
        return found;
    }
};

/// Runs an experiment; `prepare` adds TAMs and plans what happens.
Outcome perform(const std::string& name, const std::vector<const char*>& options,
                SimulatedMesh::Settings mesh_settings, double duration,
                const std::function<void(SimulatedMesh&)>& prepare) {
    SimulatedMesh mesh(mesh_settings);
    prepare(mesh);
    VirtualLine line(mesh);
    const ExperimentKind* kind = name == "visits" ? &kVisitsKind : find_experiment(name);
    REQUIRE(kind != nullptr);
    Parameters parameters;
    parameters.read_options(options);
    parameters.declare({kind->parameters()});
    const std::unique_ptr<Experiment> experiment = kind->make(parameters);
    const std::string file = tests::scratch_path("coordinator").string();
    Outcome outcome;
    {
        EventLog log(file, false);
        Settings settings;
        settings.port = "virtual";
        settings.duration = duration;
        Coordinator coordinator(line, *experiment, log, settings, [] { return false; });
        coordinator.run();
        outcome.end = coordinator.now();
    }
    outcome.events = read_events(file);
    std::filesystem::remove(file);
    outcome.tams = mesh.tams;
    outcome.commands = mesh.commands;
    outcome.bad_frames = mesh.bad_frames;
    return outcome;
}

constexpr std::uint64_t kFirst = 0x0013A200408A3100;

/// A robot that comes and goes at random.
void haunt(SimulatedMesh& mesh, SimulatedTam& tam, RandomStream& random, double until, double longest) {
    for (double time = 5 + 10 * random.uniform(); time < until;) {
        const double leaves = time + 1 + longest * random.uniform();
        mesh.plan(time, [&, time] { mesh.set_robot(tam, true, time); });
        mesh.plan(leaves, [&, leaves] { mesh.set_robot(tam, false, leaves); });
        time = leaves + 1 + 15 * random.uniform();
    }
}

}  // namespace

TEST_CASE("random-task: what each TAM goes through is by the settings") {
    RandomStream seeds(20261, "random-task");
    for (int round = 0; round < 6; ++round) {
        const double green = 2 + 4 * seeds.uniform(), blue = 6 + 8 * seeds.uniform(),
                     dead = 3 + 5 * seeds.uniform();
        const std::string durations = fmt::format("{},{}", green, blue), dead_text = fmt::format("{}", dead);
        const std::string seed = std::to_string(seeds.below(1000));
        SimulatedMesh::Settings settings;
        settings.seed = seeds.next();
        settings.loss = round % 2 == 0 ? 0 : 0.2;
        settings.noise = round % 3 == 0 ? 0 : 0.1;
        CAPTURE(round, durations, dead_text, seed);
        RandomStream robots(settings.seed, "robots");
        const Outcome outcome = perform(
            "random-task",
            {"--durations", durations.c_str(), "--dead-time", dead_text.c_str(), "--seed", seed.c_str()},
            settings, 300, [&](SimulatedMesh& mesh) {
                for (int i = 0; i < 5; ++i)
                    haunt(mesh, mesh.add(fmt::format("TAM{:02}", i), kFirst + static_cast<unsigned>(i)),
                          robots, 290, 20);
            });
        CHECK(outcome.bad_frames == 0);
        int done = 0, aborted = 0;
        std::set<std::string> offered;
        for (const auto& [name, tam] : outcome.tams) {
            CAPTURE(name);
            CHECK(tam.red + tam.green + tam.blue == 0);
            const std::vector<Event> states = outcome.of(name, "state");
            REQUIRE(states.size() > 2);
            CHECK(states[0].detail == "free");
            for (std::size_t i = 1; i < states.size(); ++i) {
                const std::string before = states[i - 1].detail, after = states[i].detail;
                const double lasted = states[i].time - states[i - 1].time;
                INFO(states[i - 1].time << " s: " << states[i - 1].value << " -> " << states[i].value);
                const std::set<std::string> legal{"closed free",   "free working", "working done",
                                                  "working pause", "done pause",   "pause free"};
                CHECK(legal.contains(before + " " + after));
                if (before == "working") {
                    const double duration = states[i - 1].value == "work on green" ? green : blue;
                    CHECK(states[i - 1].value.substr(8) == states[i - 2].value.substr(6));
                    if (after == "done")
                        CHECK(lasted == Approx(duration).margin(0.0121));
                    else
                        CHECK(lasted < duration);
                    ++(after == "done" ? done : aborted);
                }
                if (before == "pause") CHECK(lasted == Approx(dead).margin(0.0121));
                if (after == "free") offered.insert(states[i].value);
            }
            // One SET_LEDS per change, a few more where a report crosses it, and the last one at the end.
            if (settings.loss == 0)
                CHECK(static_cast<double>(outcome.of(name, "set_leds").size()) <
                      3 + 1.25 * static_cast<double>(outcome.of(name, "leds").size()));
        }
        CHECK(offered.size() == 2);
        CHECK(done > 5);
        CHECK(aborted > 2);
    }
}

TEST_CASE("the same seed gives the same events, another one does not") {
    const auto run = [](const char* seed) {
        SimulatedMesh::Settings settings;
        settings.loss = 0.1;
        RandomStream robots(5, "robots");
        return perform("random-task", {"--seed", seed}, settings, 120, [&](SimulatedMesh& mesh) {
            for (int i = 1; i < 4; ++i)
                haunt(mesh, mesh.add(fmt::format("TAM{:02}", i), kFirst + static_cast<unsigned>(i)), robots,
                      100, 10);
        });
    };
    const Outcome first = run("1");
    CHECK(first.events == run("1").events);
    CHECK(first.events != run("2").events);
}

TEST_CASE("sequence: tasks are done in order, a mistake begins the round again") {
    RandomStream seeds(20262, "sequence");
    std::uint64_t complete = 0, mistakes = 0, aborted = 0;
    for (int round = 0; round < 8; ++round) {
        const int stages = 2 + static_cast<int>(seeds.below(3));
        const bool restart = seeds.below(2) == 0;
        std::string order, colors, durations;
        for (int i = 0; i < stages; ++i) {
            order += fmt::format("{}TAM{:02}", i ? "," : "", 10 * (stages - i));
            colors += fmt::format("{}0000{:02x}", i ? "," : "", 10 + i);
            durations += fmt::format("{}{}", i ? "," : "", 2 + i);
        }
        SimulatedMesh::Settings settings;
        settings.seed = seeds.next();
        settings.loss = round % 2 == 0 ? 0 : 0.15;
        RandomStream robots(settings.seed, "robots");
        CAPTURE(round, order, restart);
        const Outcome outcome =
            perform("sequence",
                    {"--order", order.c_str(), "--colors", colors.c_str(), "--durations", durations.c_str(),
                     "--dead-time", "4", "--on-mistake", restart ? "restart" : "ignore"},
                    settings, 600, [&](SimulatedMesh& mesh) {
                        for (int i = 0; i < stages; ++i)
                            haunt(mesh,
                                  mesh.add(fmt::format("TAM{:02}", 10 * (stages - i)),
                                           kFirst + static_cast<unsigned>(i)),
                                  robots, 590, 9);
                        mesh.add("TAM77", kFirst + 77);  // of no stage: dark and alone
                    });
        CHECK(outcome.bad_frames == 0);
        CHECK(outcome.of("TAM77", "state").empty());
        // The rules again, from the table: the stage whose turn it is rises with "done" and falls with a
        // mistake.
        int stage = 0;
        std::map<std::string, std::string> activity;
        double last = 0;
        const auto open = [&activity] {
            return std::count_if(activity.begin(), activity.end(), [](const auto& item) {
                return item.second == "free" || item.second == "working";
            });
        };
        for (const Event& event : outcome.events) {
            INFO(event.time << " s " << event.tam << " " << event.event << " " << event.value);
            // One TAM closes and the next opens within two steps.
            if (event.time - last > 0.021) CHECK(open() <= 1);
            last = event.time;
            const std::string turn = fmt::format("TAM{:02}", 10 * (stages - stage));
            if (event.event == "state") {
                activity[event.tam] = event.detail;
                if (event.detail == "working") CHECK(event.tam == turn);
            }
            if (event.event != "task") continue;
            if (event.value == "done") {
                CHECK(event.tam == turn);
                if (++stage == stages) {
                    stage = 0;
                    ++complete;
                }
            } else if (event.value == "mistake") {
                ++mistakes;
                if (restart) stage = 0;
            } else if (event.value == "aborted") {
                ++aborted;
                CHECK(event.tam == turn);
            }
        }
        for (const auto& [name, tam] : outcome.tams)
            CHECK(tam.red + tam.green + tam.blue == 0);
    }
    CHECK(complete > 3);
    CHECK(mistakes > 10);
    CHECK(aborted > 2);
}

TEST_CASE("sequence: ends behind its rounds, answers robots by infra-red") {
    const Outcome outcome = perform(
        "sequence", {"--order", "TAM01,TAM02", "--rounds", "2", "--durations", "1,1", "--dead-time", "1"}, {},
        0, [](SimulatedMesh& mesh) {
            SimulatedTam& a = mesh.add("TAM01", kFirst);
            SimulatedTam& b = mesh.add("TAM02", kFirst + 1);
            for (double t = 10; t < 50; t += 20) {
                mesh.plan(t, [&, t] { mesh.set_robot(a, true, t); });
                mesh.plan(t + 5, [&, t] { mesh.set_robot(a, false, t + 5); });
                mesh.plan(t + 8, [&, t] { mesh.set_robot(b, true, t + 8); });
                mesh.plan(t + 13, [&, t] { mesh.set_robot(b, false, t + 13); });
            }
        });
    CHECK(outcome.events.back().value == "finished");
    CHECK(outcome.end < 45);
    std::vector<std::string> written;
    for (const Event& event : outcome.of("TAM02", "write_robot"))
        written.push_back(event.value);
    CHECK(written == std::vector<std::string>{"10", "7f", "10", "7f"});
    CHECK(outcome.tams.at("TAM01").written == 0x7F);
}

TEST_CASE("the module's start-up, discovery and periods are those of the sheet") {
    const Outcome outcome = perform("random-task", {}, {}, 125, [](SimulatedMesh& mesh) {
        mesh.add("TAM01", kFirst);
        mesh.add("TAM02", kFirst + 1, 30);  // boots later: found by its first report
        mesh.add("COORD", kFirst + 2);      // another coordinator: ignored
        mesh.add("TAM1", kFirst + 3);
    });
    REQUIRE(outcome.commands.size() >= 6);
    const std::vector<std::string> first(outcome.commands.begin(), outcome.commands.begin() + 6);
    CHECK(first == std::vector<std::string>{"AP", "HV", "VR", "NT", "DB", "ND"});
    CHECK(std::count(outcome.commands.begin(), outcome.commands.end(), "DB") == 3);
    REQUIRE(outcome.of("TAM02", "discovered").size() == 1);
    CHECK(outcome.of("TAM02", "discovered")[0].time > 30);
    CHECK(outcome.of("TAM02", "discovered")[0].value == "0013A200408A3101");
    CHECK(outcome.of("TAM1", "").empty());
    CHECK(outcome.tams.at("COORD").set_leds_at.empty());
}

TEST_CASE("a TAM that dies is given up, one that comes back under another address is taken in") {
    const Outcome outcome = perform("random-task", {}, {}, 120, [](SimulatedMesh& mesh) {
        SimulatedTam& tam = mesh.add("TAM05", kFirst);
        mesh.plan(20, [&] { tam.alive = false; });
        mesh.plan(60, [&] {
            tam.alive = true;
            tam.address = kFirst + 9;
            tam.red = tam.green = tam.blue = 0;
        });
    });
    CHECK(outcome.of("TAM05", "lost").size() == 1);
    CHECK(outcome.of("TAM05", "discovered").size() == 2);
    CHECK(outcome.of("TAM05", "leds").size() >= 2);
}

TEST_CASE("a mesh that answers late costs time-outs, and nothing else") {
    SimulatedMesh::Settings slow;
    slow.latency = 0.9;  // up to 3.6 s there, and as much back
    RandomStream robots(17, "robots");
    const Outcome outcome = perform("random-task", {"--durations", "2,3", "--dead-time", "1"}, slow, 200,
                                    [&](SimulatedMesh& mesh) {
                                        haunt(mesh, mesh.add("TAM01", kFirst), robots, 190, 15);
                                        haunt(mesh, mesh.add("TAM02", kFirst + 1), robots, 190, 15);
                                    });
    CHECK_FALSE(outcome.of("TAM01", "timeout").empty());
    for (const char* tam : {"TAM01", "TAM02"}) {
        CHECK(outcome.of(tam, "task").size() > 2);
        CHECK(outcome.of(tam, "lost").empty());
        CHECK(outcome.tams.at(tam).red + outcome.tams.at(tam).green + outcome.tams.at(tam).blue == 0);
    }
}

TEST_CASE("a module in API mode 1 is set to 2, odd modules are refused with the step") {
    SimulatedMesh::Settings settings;
    settings.api_mode = 1;
    CHECK(perform("random-task", {}, settings, 1, [](SimulatedMesh&) {}).commands.at(1) == "AP");
    settings.window = 0;
    CHECK_THROWS_WITH(perform("random-task", {}, settings, 1, [](SimulatedMesh&) {}),
                      Catch::Contains("virtual: start-up step 4, NT"));
    settings.answers = false;
    CHECK_THROWS_WITH(perform("random-task", {}, settings, 1, [](SimulatedMesh&) {}),
                      Catch::Contains("virtual: start-up step 1, AP") &&
                          Catch::Contains("no answer within 5 s"));
}

TEST_CASE("random bytes and damaged frames never stop the coordinator") {
    RandomStream random(99, "fuzz");
    for (int round = 0; round < 20; ++round) {
        SimulatedMesh::Settings settings;
        settings.seed = random.next();
        const Outcome outcome = perform("random-task", {}, settings, 60, [&](SimulatedMesh& mesh) {
            SimulatedTam& tam = mesh.add("TAM01", kFirst);
            for (double time = 2; time < 40; time += 0.3) {
                std::vector<std::uint8_t> bytes(random.below(60));
                for (std::uint8_t& byte : bytes)
                    byte = static_cast<std::uint8_t>(random.next());
                if (random.below(2) == 0) {  // a sound frame of random content
                    const std::uint8_t types[] = {0x88, 0x8A, 0x8B, 0x90, 0x97, 0x08};
                    if (!bytes.empty()) bytes[0] = types[random.below(6)];
                    if (bytes.size() > 4 && bytes[0] == 0x88 && random.below(2) == 0)
                        bytes[2] = 'N', bytes[3] = 'D';
                    if (bytes.size() > 10 && bytes[0] == 0x90 && random.below(2) == 0)
                        for (int i = 0; i < 8; ++i)
                            bytes[static_cast<std::size_t>(1 + i)] =
                                static_cast<std::uint8_t>(tam.address >> (56 - 8 * i));
                    bytes = protocols::encode_xbee(bytes, protocols::XBeeApiMode::Escaped);
                }
                mesh.plan(time, [&mesh, bytes, time] { mesh.send_raw(bytes, time); });
            }
        });
        CHECK(outcome.events.back().event == "ended");
        CHECK(outcome.bad_frames == 0);
        CHECK_FALSE(outcome.of("TAM01", "state").empty());
    }
}

TEST_CASE("the experiment of the documentation works, and is the one that is documented") {
    const Outcome outcome = perform("visits", {"--visits", "3"}, {}, 0, [](SimulatedMesh& mesh) {
        SimulatedTam& tam = mesh.add("TAM09", kFirst);
        for (double t = 5; t < 60; t += 10) {
            mesh.plan(t, [&, t] { mesh.set_robot(tam, true, t); });
            mesh.plan(t + 4, [&, t] { mesh.set_robot(tam, false, t + 4); });
        }
    });
    CHECK(outcome.of("TAM09", "visit").size() == 3);
    CHECK(outcome.tams.at("TAM09").written == 0x42);
    CHECK(outcome.end < 30);
    const auto text_of = [](const std::string& file, const std::string& begin, const std::string& end) {
        std::ifstream in(std::string(PUCKLOOP_SOURCE) + file);
        const std::string text(std::istreambuf_iterator<char>(in), {});
        const std::size_t first = text.find(begin) + begin.size();
        return text.substr(first, text.find(end, first) - first);
    };
    const std::string example = text_of("/tests/coordinator/visits.h", "// begin\n", "// end\n");
    CHECK(example.size() > 1000);
    CHECK(text_of("/docs/coordinator.md", "```cpp\n", "```") == example);
}
