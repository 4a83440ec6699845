// The event table and the picture.

#include "base/error.h"
#include "base/random.h"
#include "linuxboard/coordinator/event_log.h"
#include "linuxboard/coordinator/experiments/experiments.h"
#include "linuxboard/coordinator/gantt.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>

using namespace puckloop;
using namespace puckloop::coordinator;

TEST_CASE("an event survives its line, whatever printable text it has") {
    RandomStream random(1, "events");
    for (int i = 0; i < 500; ++i) {
        Event event{static_cast<double>(random.below(1'000'000)) / 1000, "TAM01", "", "", ""};
        for (std::string* text : {&event.event, &event.value, &event.detail})
            for (std::uint64_t n = random.below(12); n > 0; --n)
                *text += static_cast<char>(random.below(3) == 0 ? ",\" x"[random.below(4)]
                                                                : 0x20 + static_cast<char>(random.below(95)));
        const std::string line = to_csv(event);
        CAPTURE(line);
        const Event back = from_csv(line, "f", 2);
        CHECK(back.time == Approx(event.time));
        CHECK(back.event == event.event);
        CHECK(back.value == event.value);
        CHECK(back.detail == event.detail);
    }
    CHECK(to_csv({1, "", "a\nb\x80", "", ""}) == "1.000,,a\\x0ab\\x80,,");
}

TEST_CASE("damaged tables are refused with file and line, or read") {
    const std::string file = tests::scratch_path("events").string();
    RandomStream random(2, "damage");
    std::string sound =
        std::string(kEventColumns) + "\n0.000,,started,\"a,b\",\n1.500,TAM01,state,offer,free\n";
    for (int i = 0; i < 300; ++i) {
        std::string text = sound;
        for (std::uint64_t n = 1 + random.below(3); n > 0; --n)
            text[random.below(text.size())] = static_cast<char>(random.next());
        std::ofstream(file, std::ios::binary) << text.substr(0, random.below(text.size() + 1));
        try {
            const std::string svg = gantt_svg(read_events(file), "t");
            CHECK(svg.starts_with("<svg"));
        } catch (const InputError& error) {
            CHECK(std::string(error.what()).starts_with(file + ": line "));
        }
    }
    std::ofstream(file) << sound << "2.000,TAM01,sta";  // the program was killed here
    CHECK(read_events(file).size() == 2);
    std::filesystem::remove(file);
}

TEST_CASE("the picture has a bar for each state, as long as it lasted") {
    const std::string svg = gantt_svg({{0, "TAM02", "state", "offer <a>", "free"},
                                       {4, "TAM02", "robot", "in", ""},
                                       {5, "TAM02", "state", "work", "working"},
                                       {8, "TAM02", "robot", "out", ""},
                                       {10, "", "ended", "signal", ""}},
                                      "test");
    CHECK(svg.find("<title>TAM02: offer &lt;a&gt;, 0.00 s to 5.00 s</title>") != std::string::npos);
    CHECK(svg.find("<title>TAM02: work, 5.00 s to 10.00 s</title>") != std::string::npos);
    CHECK(svg.find("<title>TAM02: robot inside, 4.00 s to 8.00 s</title>") != std::string::npos);
    CHECK(svg.find("width=\"550.00\"") != std::string::npos);
    CHECK(gantt_svg({}, "empty").find("</svg>") != std::string::npos);
}

TEST_CASE("damaged parameter files make an experiment, or one line with the file's name") {
    const std::string file = tests::scratch_path("parameters.toml").string();
    const std::string texts[] = {
        "tasks = [\"a\", \"b\", \"c\"]\ncolors = [\"190000\", \"001900\", \"000019\"]\n"
        "durations = [1, 2.5, 3]\nbusy_color = \"191900\"\ndead-time = 4\nseed = 99\n",
        "order = [\"TAM03\", \"TAM01\"]\ncolors = [\"190000\", \"001900\"]\n"
        "durations = [1, 2.5]\non_mistake = \"ignore\"\nrounds = 3\ntime_limit = 1e3\n"};
    RandomStream random(31, "parameters");
    int made = 0, refused = 0;
    for (int i = 0; i < 600; ++i) {
        const std::size_t which = random.below(2);
        const ExperimentKind& kind = experiments()[which];
        std::string text = texts[which];
        for (std::uint64_t n = random.below(3); n > 0; --n) {
            const std::size_t at = random.below(text.size());
            switch (random.below(3)) {
            case 0:
                text[at] = static_cast<char>(random.next());
                break;
            case 1:
                text.erase(at, 1 + random.below(4));
                break;
            default:
                text.insert(at, 1, "0\"[],=\n.-x"[random.below(10)]);
            }
        }
        std::ofstream(file, std::ios::binary) << text;
        CAPTURE(text);
        try {
            Parameters parameters;
            parameters.read_file(file);
            parameters.declare({kind.parameters()});
            const auto experiment = kind.make(parameters);
            CHECK_FALSE(experiment->finished());
            ++made;
        } catch (const InputError& error) {
            const std::string what = error.what();
            CHECK(what.starts_with(file + ": "));
            CHECK(what.find('\n') == std::string::npos);
            ++refused;
        }
    }
    CHECK(made > 100);
    CHECK(refused > 100);
    std::filesystem::remove(file);
}
