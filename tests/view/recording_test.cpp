// What a page knows at once of a results folder, what is refused, and what is noted.

#include "base/error.h"
#include "base/json.h"
#include "tests/kit/files.h"
#include "tests/view/results.h"
#include "view/events/read_events.h"
#include "view/recording/recording.h"

#include <catch2/catch.hpp>

#include <cstring>
#include <filesystem>
#include <iterator>
#include <random>

using namespace puckloop;
using namespace puckloop::tests;
using view::EventReader;
using view::Recording;
namespace fs = std::filesystem;

namespace {

std::string refusal(const fs::path& folder) {
    try {
        const Recording recording(folder);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

nlohmann::json status_of(EventReader& events) {
    events.wait();
    return nlohmann::json::parse(events.status());
}

}  // namespace

TEST_CASE("a whole folder: head, poses, sensors") {
    const Recording recording(write_results("view_whole"));
    CHECK(recording.notes().empty());
    const auto head = nlohmann::json::parse(recording.head());
    CHECK(head["duration_s"] == 2.0);
    CHECK(head["report"]["scenario"] == "a.toml");
    CHECK(head["report"]["seed"] == 7);
    CHECK(head["report"]["warnings"] == nlohmann::json{"robot0.pic: look here"});
    CHECK(head["stations"] == nlohmann::json{"robot0"});
    CHECK(head["arena"]["corners"].size() == 4);
    CHECK(head["arena"]["fixed"].size() == 4);
    CHECK(head["arena"]["things"][0]["name"] == "carton");
    CHECK(head["arena"]["robots"][0]["radius"].get<double>() > 0.03);
    CHECK(head["sensors"] == nlohmann::json{"proximity0", "battery_v"});
    const std::string poses = recording.poses();
    REQUIRE(poses.size() == 4 + 21 * 16);
    float x = 0;
    std::memcpy(&x, poses.data() + 4 + 21 * 4 + 20 * 4, sizeof x);
    CHECK(x == 0.2F);
    CHECK(recording.sensors(0).size() == 8 + 21 * (8 + 2 * 4));
    CHECK(recording.sensors(1).size() == 8 + 0);
}

TEST_CASE("events: frames with what is wrong, resets, lines of logs, LEDs") {
    const Recording recording(write_results("view_events"));
    EventReader events(recording);
    const auto status = status_of(events);
    CHECK(status["done"] == true);
    CHECK(status["trouble"] == "");
    CHECK(status["left_out"] == 0);
    const auto& table = events.table();
    CHECK(table.find("41", 10).size() == 1);  // 'A'
    REQUIRE(table.find("fault flip", 10).size() == 1);
    CHECK(table.find("hello", 10).size() == 1);
    CHECK(table.find("MCLR", 10).size() == 1);
    CHECK(table.find("no time", 10).empty());
    CHECK(status["leds"] == 2);
    const std::string leds = events.leds(0, 10);
    CHECK(leds.size() == 16 + 2 * 12);
    double time = 0;
    std::memcpy(&time, leds.data() + 16, sizeof time);
    CHECK(time == 0.25);
    CHECK(leds[leds.size() - 3] == 3);  // the second change's LED
    CHECK(leds[leds.size() - 2] == 1);
    CHECK(leds[leds.size() - 1] == 0);
    std::vector<std::string> tracks;
    for (const auto& track : status["tracks"])
        tracks.push_back(track["name"]);
    for (const char* name : {"robot0.uart1 robot0.pic", "robot0.pic log", "robot0.pic resets"}) {
        INFO(name);
        CHECK(std::find(tracks.begin(), tracks.end(), name) != tracks.end());
    }
}

TEST_CASE("what is no results folder is refused with the remedy") {
    const fs::path folder = write_results("view_refused");
    CHECK(has(refusal(folder / "nowhere"), "no such folder"));
    CHECK(has(refusal(folder / "report.json"), "is no folder"));
    fs::create_directories(folder / "empty");
    const std::string empty = refusal(folder / "empty");
    CHECK(has(empty, "neither trajectory.csv nor trace.csv"));
    CHECK(has(empty, "puckloop run"));
    write_text(folder / "report.json", R"({"format":2})");
    CHECK(has(refusal(folder), "format: is 2"));
    CHECK(has(refusal(folder), "run the scenario again"));
    write_text(folder / "report.json", "{");
    CHECK(has(refusal(folder), "report.json"));
    fs::remove(folder / "report.json");
    CHECK(refusal(folder).empty());
    const std::string arena = text_of(folder / "arena.json");
    write_text(folder / "arena.json", R"({"format":9,"world":{}})");
    CHECK(has(refusal(folder), "arena.json: format: is 9"));
    for (const char* damaged :
         {"", "[]", R"({"format":1})", R"({"format":1,"world":{}})", R"({"format":"1","world":3})"}) {
        INFO(damaged);
        write_text(folder / "arena.json", damaged);
        CHECK(has(refusal(folder), "arena.json"));
        CHECK(has(refusal(folder), "run the scenario again"));
    }
    write_text(folder / "arena.json", arena);
    CHECK(refusal(folder).empty());
}

TEST_CASE("an incomplete folder is shown, and a note names what is missing") {
    const fs::path folder = write_results("view_incomplete");
    fs::remove(folder / "report.json");
    fs::remove(folder / "arena.json");
    write_text(folder / "trajectory.csv", text_of(folder / "trajectory.csv") + "2.1,robot0,0.0");
    write_text(folder / "trace.csv", text_of(folder / "trace.csv") + "1.5,robot0.ua");
    write_text(folder / "sensors.csv", text_of(folder / "sensors.csv") + "2.1,rob");
    const Recording recording(folder);
    REQUIRE(recording.notes().size() == 2);
    CHECK(has(recording.notes()[0], "report.json is not there"));
    CHECK(has(recording.notes()[1], "run the scenario again"));
    CHECK(recording.duration_s() == 2.0);
    CHECK(recording.robots() == 1);
    CHECK(recording.sensors(0).size() == 8 + 21 * (8 + 2 * 4));
    EventReader events(recording);
    CHECK(status_of(events)["trouble"] == "");
    fs::remove(folder / "trace.csv");
    const Recording without(folder);
    CHECK(without.notes().size() == 3);
    EventReader few(without);
    CHECK(status_of(few)["trouble"] == "");
    CHECK(few.table().find("hello", 10).size() == 1);
}

TEST_CASE("a damaged trace is reported with its line, and what was read before stays") {
    const fs::path folder = write_results("view_damaged");
    write_text(folder / "trace.csv", text_of(folder / "trace.csv") + "rubbish\n1,2\n");
    const Recording recording(folder);
    EventReader events(recording);
    CHECK_THROWS_AS(events.wait(), InputError);
    const auto status = nlohmann::json::parse(events.status());
    CHECK(has(status["trouble"], "trace.csv: line 7"));
    CHECK(status["done"] == true);
    CHECK(events.table().find("hello", 10).size() == 1);
}

TEST_CASE("random damage to any file is an error with its place or is shown, never a crash") {
    std::mt19937 random(Catch::rngSeed());
    for (int round = 0; round < 150; ++round) {
        const fs::path folder = write_results("view_fuzz");
        const char* names[] = {"report.json", "arena.json", "trajectory.csv",
                               "sensors.csv", "trace.csv",  "robot0.pic.log"};
        const fs::path file = folder / names[random() % 6];
        std::string text = text_of(file);
        for (int k = 0; k < 4; ++k) {
            if (text.empty()) break;
            const std::size_t at = random() % text.size();
            switch (random() % 4) {
            case 0:
                text[at] = static_cast<char>(random());
                break;
            case 1:
                text.erase(at, random() % 40);
                break;
            case 2:
                text.insert(at, text.substr(random() % text.size(), random() % 60));
                break;
            default:
                text.resize(at);
                break;
            }
        }
        write_text(file, text);
        INFO("round " << round << ", " << file);
        try {
            const Recording recording(folder);
            CHECK(nlohmann::json::parse(recording.head()).is_object());
            recording.poses();
            EventReader events(recording);
            try {
                recording.sensors(0);
                events.wait();
            } catch (const InputError&) {
            } catch (const RunError&) {
            }
            CHECK(nlohmann::json::parse(events.status())["done"].is_boolean());
        } catch (const InputError& error) {
            CHECK_FALSE(error.file().empty());
        } catch (const RunError& error) {
            CHECK(has(error.what(), "line"));
        }
    }
}

TEST_CASE("reading stops when nobody wants it any more") {
    const fs::path folder = write_results("view_stop");
    std::string trace = text_of(folder / "trace.csv");
    const std::string rows = trace.substr(trace.find('\n') + 1);
    for (int k = 0; k < 40'000; ++k)
        trace += rows;  // times go back: nobody minds here
    write_text(folder / "trace.csv", trace);
    const Recording recording(folder);
    const auto begun = std::chrono::steady_clock::now();
    { const EventReader events(recording); }
    CHECK(std::chrono::steady_clock::now() - begun < std::chrono::seconds(1));
}
