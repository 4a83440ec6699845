// [[event]] tables and commands: one grammar, either way.

#include "base/error.h"
#include "base/random.h"
#include "scenarios/reader/events/action_forms.h"
#include "scenarios/reader/events/command_text.h"
#include "scenarios/reader/events/event_tables.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace puckloop;
using namespace puckloop::scenarios;
using physics::Verb;

namespace {

std::string json_of(const physics::Action& action) {
    physics::EventPlan plan;
    plan.events.emplace_back().action = action;
    return physics::to_json(plan);
}

const std::string kWorld = "[run]\nduration = \"5 s\"\n[arena]\nsize = [\"1 m\", \"80 cm\"]\n"
                           "[[robot]]\nposition = [\"0 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"x.hex\"\n"
                           "[[cylinder]]\nname = \"can\"\ncentre = [\"30 cm\", \"0 cm\"]\nradius = \"5 cm\"\n"
                           "[[lamp]]\ncentre = [\"-30 cm\", \"0 cm\"]\n";  // the next line is 15

physics::Event event_of(const std::string& text) {
    const TemporaryFile file(kWorld + "[[event]]\n" + text);
    return read_scenario(file.path()).events.events.at(0);
}

std::string problem_of(const std::string& text) {
    const TemporaryFile file(kWorld + "[[event]]\n" + text);
    try {
        read_scenario(file.path());
    } catch (const InputError& error) {
        const std::string what = error.what();
        CHECK(what.starts_with(file.path() + ": line "));
        return what.substr(file.path().size() + 2);
    }
    return "accepted";
}

std::string command_problem(const std::string& text) {
    try {
        parse_command(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("an event has a time or a condition, and one action") {
    const auto move =
        event_of("at = \"20.5 s\"\nmove = \"can\"\nto = [\"10 cm\", \"-10 cm\"]\nover = \"2 s\"\n");
    CHECK(*move.at == 20'500 * cosim::kMillisecond);
    CHECK(move.name == "event 1");
    CHECK(move.action.verb == Verb::Move);
    CHECK(move.action.to == physics::Point{0.1, -0.1});
    CHECK(move.action.over == 2.0);
    CHECK(move.action.command == "move can to 10 cm, -10 cm over 2 s");
    CHECK(move.action.toml == "move = \"can\"\nto = [\"10 cm\", \"-10 cm\"]\nover = \"2 s\"\n");
    const auto often = event_of("at = \"1 s\"\nevery = \"2 s\"\ncount = 3\nreset = \"robot0\"\n");
    CHECK(often.every == 2 * cosim::kSecond);
    CHECK(often.count == 3);
    const auto near =
        event_of("label = \"close\"\nwhen = { robot = \"robot0\", near = \"can\", within = \"5 cm\" }\n"
                 "delay = \"100 ms\"\nswitch_off = \"lamp 1\"\n");
    CHECK(near.name == "close");
    CHECK(near.when->kind == physics::Condition::Kind::Near);
    CHECK(near.when->distance == 0.05);
    CHECK(near.delay == 100 * cosim::kMillisecond);
    const auto add = event_of("at = \"0 s\"\nadd = \"box\"\nname = \"b\"\ncentre = [\"0 cm\", \"30 cm\"]\n"
                              "size = [\"5 cm\", \"6 cm\", \"7 cm\"]\nmass = \"20 g\"\n");
    REQUIRE(add.action.thing.boxes.size() == 1);
    CHECK(add.action.thing.boxes[0].movable);
    CHECK(add.action.thing.boxes[0].width == 0.06);
}

TEST_CASE("every mistake in an event is one line with its place") {
    CHECK(problem_of("at = \"1 s\"\nmove = \"cann\"\nto = [\"0 m\", \"20 cm\"]\n") ==
          "line 15: event 1: there is no 'cann' in this world (expected perhaps 'can')");
    CHECK(problem_of("at = \"1 s\"\nmove = \"can\"\nto = [\"3 m\", \"20 cm\"]\n") ==
          "line 15: event 1: (3 m, 0.2 m) is outside the arena");
    CHECK(problem_of("at = \"1 s\"\nmove = \"robot0\"\nto = [\"30 cm\", \"2 cm\"]\n") ==
          "line 15: event 1: (0.3 m, 0.02 m) is taken by 'can'");
    CHECK(problem_of("at = \"1 s\"\nmove = \"robot0\"\nto = [\"49 cm\", \"2 cm\"]\n")
              .starts_with("line 15: event 1: (0.49 m, 0.02 m) is too close to the arena's wall"));
    CHECK(problem_of("move = \"can\"\nto = [\"0 m\", \"20 cm\"]\n")
              .starts_with("line 15: event 1: no time and no condition"));
    CHECK(problem_of("at = \"1 s\"\n").starts_with("line 15: event 1: no action"));
    CHECK(problem_of("at = \"1 s\"\nmoove = \"can\"\n") ==
          "line 17: event 1: unknown key 'moove' (expected perhaps 'move')");
    CHECK(problem_of("at = \"1 s\"\nmove = \"can\"\ntoo = [\"0 m\", \"0 m\"]\n")
              .starts_with("line 17: event 1: no place to move to"));
    CHECK(problem_of("at = \"1 s\"\nmove = \"can\"\nto = [\"0 m\"]\n")
              .starts_with("line 18: event 1: to is not a list of 2"));
    CHECK(problem_of("at = \"1 s\"\nlift = \"can\"\n") ==
          "line 15: event 1: 'can' is a cylinder (expected a robot)");
    CHECK(problem_of("at = \"1 s\"\nreset = \"robot0\"\nselect = \"robot0\"\nposition = 1\n")
              .starts_with("line 15: event 1: more than one action"));
    CHECK(problem_of("at = \"1 s\"\nselect = \"robot0\"\nposition = 16\n")
              .starts_with("line 18: event 1: position is out of range"));
    CHECK(problem_of("at = \"1 s\"\nset = \"lamp 1\"\ngrey = 0.5\n") ==
          "line 15: event 1: 'lamp 1', a lamp, has no grey");
    CHECK(problem_of("when = { after = \"nothing\" }\nreset = \"robot0\"\n") ==
          "line 15: event 1: after: there is no other event 'nothing'");
    CHECK(problem_of("when = { robot = \"robot0\", nea = \"can\" }\nreset = \"robot0\"\n") ==
          "line 16: event 1: when: unknown key 'nea' (expected perhaps 'near')");
    CHECK(problem_of("at = \"1 s\"\nadd = \"box\"\nname = \"b\"\ncentre = [\"30 cm\", \"0 cm\"]\n"
                     "size = [\"5 cm\", \"6 cm\", \"7 cm\"]\n") ==
          "line 15: event 1: (0.3 m, 0 m) is taken by 'can'");
    CHECK(problem_of("at = \"1 s\"\nreset = \"robot0\"\ncount = 2\n")
              .starts_with("line 18: event 1: a count without repetition"));
    CHECK(problem_of("at = \"1 s\"\nremove = \"robot0\"\n")
              .starts_with("line 15: event 1: 'robot0' is a robot"));
}

TEST_CASE("commands do what tables do") {
    const auto move = parse_command("move can to 10 cm, -20 cm heading 90 deg over 2 s");
    CHECK(move.object == "can");
    CHECK(move.to == physics::Point{0.1, -0.2});
    CHECK(*move.heading == Approx(std::numbers::pi / 2));
    CHECK(parse_command("switch_off lamp 1").object == "lamp 1");
    CHECK(parse_command("switch_off \"lamp 1\"").command == "switch_off \"lamp 1\"");
    CHECK(parse_command("select robot0 position 7").number == 7);
    CHECK(parse_command("remote all key 5 address 8 hold 200 ms").hold == 0.2);
    CHECK(parse_command("set floor grey 20 %").value == 0.2);
    const auto box = parse_command("add box name b centre 1 cm, 2 cm size 3 cm, 4 cm, 5 cm mass 10 g");
    CHECK(box.thing.boxes.at(0).mass == 0.01);
    CHECK(box.toml == "add = \"box\"\nname = \"b\"\ncentre = [\"1 cm\", \"2 cm\"]\n"
                      "size = [\"3 cm\", \"4 cm\", \"5 cm\"]\nmass = \"10 g\"\n");
    CHECK(command_problem("") == "command: it is empty (expected such as \"move can to 10 cm, 0 cm\")");
    CHECK(command_problem("moev can to 1 cm, 1 cm") ==
          "command: 'moev' is unknown (expected perhaps 'move')");
    CHECK(command_problem("move can to 1, 2") ==
          "command: to: '1' has no unit (expected a length such as \"25 cm\")");
    CHECK(command_problem("move") == "command: 'move' has no value (expected move OBJECT [to X, Y | by X, Y] "
                                     "[heading ANGLE] [over TIME])");
    CHECK(command_problem("select robot0 position many").starts_with("command: position is out of range"));
    CHECK(command_problem("add house name x").starts_with("command: add: 'house name x' is not known"));
    CHECK(command_problem("move \"can to 1 cm, 1 cm") == "command: a quote is not closed (expected \"...\")");
}

TEST_CASE("a command becomes a table and a table a command without loss") {
    for (const char* text :
         {"move can to 10 cm, 0 cm", "move \"lamp 1\" by -1 mm, 2 m heading -3 rad over 500 ms", "remove can",
          "lift robot0", "put robot0 to 1 cm, 2 cm heading 0 deg", "set light ambient 3", "switch_on to",
          "reset robot0", "select robot0 position 15", "remote robot0 key 63 address 31",
          "add lamp name \"my lamp\" centre 1 cm, 1 cm intensity 0.5",
          "add floor_patch name p centre 0 m, 0 m grey 0.1 shape disc radius 4 cm",
          "add wall name w from 0 m, 0 m to 10 cm, 10 cm", "add speaker name s position 0 m, 1 m level 100",
          "add speaker name t position 0 m, 1 m level 100 on 1 s duration 30 ms every 1 s times 3 wave noise",
          "add cylinder name c centre 0 m, 0 m radius 1 cm", "send manager text \"range 0.5\"",
          "send robot0 text stop port 9", "send a text \"text port send\" port 65535"}) {
        INFO(text);
        const auto action = parse_command(text);
        CHECK(action.command == text);
        const TemporaryFile file("[[event]]\nat = \"1 s\"\n" + action.toml);
        auto again = read_event_file(file.path()).at(0).action;
        for (auto* lists : {&again.thing})  // places are of the file
            for (auto& box : lists->walls)
                box.place.clear();
        CHECK(again.command == action.command);
        CHECK(again.toml == action.toml);
    }
}

TEST_CASE("no line of words brings the grammar down, and what it takes it gives back (seeded)") {
    std::vector<std::string> words{"10 cm,", "0 cm", "-5 deg", "can", "\"lamp 1\"", "robot0", "floor",
                                   "2 s",    "7",    "0.5",    "nan", "1e999 m",    "all",    "\"",
                                   ",",      "box",  "disc",   "=",   "[",          "\\"};
    for (const auto& form : action_forms()) {
        words.emplace_back(form.verb);
        for (const auto& key : form.keys)
            words.emplace_back(key.name);
    }
    for (const auto& form : thing_forms())
        for (const auto& key : form.keys)
            words.emplace_back(key.name);
    RandomStream random(20, "command fuzz");
    int taken = 0;
    for (int i = 0; i < 20'000; ++i) {
        // Half of them begin well.
        std::string text =
            random.below(2) == 0 ? "" : std::string(action_forms()[random.below(action_forms().size())].verb) + " can";
        for (auto n = random.below(9); n > 0; --n)
            text += " " + words[random.below(words.size())];
        if (random.below(10) == 0 && !text.empty())
            text[random.below(text.size())] = static_cast<char>(random.below(256));
        try {
            const auto action = parse_command(text);
            ++taken;
            const auto again = parse_command(action.command);
            CHECK(again.command == action.command);
            CHECK(again.toml == action.toml);
            CHECK(json_of(again) == json_of(action));
        } catch (const InputError& error) {
            const std::string what = error.what();
            CHECK(what.find('\n') == std::string::npos);
        }
    }
    CHECK(taken > 500);
}
