// Words of light with everything drawn: places, headings, words, intervals, clocks. Robot to robot, robot to
// TAM and back. What receivers make of them is held beside the words that were sent (ircom.csv).
//
// PUCKLOOP_IRCOM_RUNS is the number of runs (3).

#include "base/random.h"
#include "tests/end_to_end/kit/workbench.h"
#include "tests/end_to_end/tam/tam_visits.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <regex>

using namespace puckloop;
using namespace puckloop::tests;

namespace {

struct Drawn {
    std::string text;
    std::vector<int> words;  ///< of robot0, 1, 2
    int task = 0;            ///< what the TAM sends to the robot in it
};

std::string robot(int number, double x, double y, double heading, int word, RandomStream& random) {
    return fmt::format(
        "[[robot]]\nname = \"robot{}\"\nposition = [\"{:.2f} cm\", \"{:.2f} cm\"]\nheading = \"{:.1f} deg\"\n"
        "[robot.pic]\nfirmware = \"" PUCKLOOP_SOURCE
        "/firmware/epuck/epuck_ircom.hex\"\ncrystal_error = \"{:.1f} ppm\"\n[robot.linux]\n"
        "program = [\"puckloop-control\", \"--behaviour\", \"still\", \"--ircom-send\", \"{}\", "
        "\"--ircom-every\", \"{:.2f}\", \"--duration\", \"9\"]\nstart = \"{:.0f} ms\"\n",
        number, x, y, heading, 100 * (random.uniform() - 0.5), word, 0.45 + 0.4 * random.uniform(),
        200 + 200 * random.uniform());
}

Drawn draw(RandomStream& random) {
    Drawn drawn;
    for (int i = 0; i < 3; ++i)
        drawn.words.push_back(static_cast<int>(random.below(256)));
    drawn.task = 1 + static_cast<int>(random.below(255));
    const double way = 2 * std::numbers::pi * random.uniform(), distance = 8.5 + 6 * random.uniform();
    drawn.text =
        fmt::format("[run]\nduration = \"8 s\"\nseed = {}\n[arena]\nsize = [\"1.2 m\", \"90 cm\"]\n"
                    "[[tam]]\nname = \"tam0\"\nposition = [\"30 cm\", \"20 cm\"]\nheading = \"-90 deg\"\n"
                    "resonator_error = \"{:.2f} %\"\n[coordinator]\nprogram = [\"puckloop-coordinator\", "
                    "\"--experiment\", "
                    "\"random-task\", \"--colors\", \"001900\", \"--tasks\", \"work\", \"--durations\", "
                    "\"3\", \"--words\", \"{}\"]\n"
                    "start = \"0.5 s\"\nparameters = {{ NT = 32 }}\n",
                    random.below(1'000'000), 0.4 * (random.uniform() - 0.5), drawn.task);
    drawn.text += robot(0, -25, -5, 360 * random.uniform(), drawn.words[0], random);
    drawn.text += robot(1, -25 + distance * std::cos(way), -5 + distance * std::sin(way),
                        360 * random.uniform(), drawn.words[1], random);
    // The booth leaves no room for another place.
    drawn.text += robot(2, 30, 20, 80 + 20 * random.uniform(), drawn.words[2], random);
    return drawn;
}

/// How often a robot's program printed a word; all others.
std::pair<int, int> heard(const Workbench& bench, int robot, int word) {
    const std::string log = text_of(bench.out("o") / fmt::format("robot{}.linux.log", robot));
    const std::regex line("infra-red word 0x([0-9a-f]{2}) from");
    int right = 0, wrong = 0;
    for (std::sregex_iterator match(log.begin(), log.end(), line), end; match != end; ++match)
        ++(std::stoi((*match)[1], nullptr, 16) == word ? right : wrong);
    return {right, wrong};
}

/// Words that could be heard: nothing beside them, the receiver silent, and it is up.
int sent(const Workbench& bench, const std::string& from, const std::string& to, int word = -1) {
    int words = 0;
    for (const Row& row : bench.csv("o", "ircom.csv"))
        words += row.at("sender") == from && row.at("receiver") == to && row.at("overlap") == "0" &&
                 row.at("receiver_sending") == "0" && row.at("fault") == "none" &&
                 std::stod(row.at("t_s")) > 0.7 && std::stod(row.at("end_s")) < 7.9 &&
                 (word < 0 || row.at("word") == fmt::format("{:02X}", word));
    return words;
}

}  // namespace

TEST_CASE("words cross between robots and between robot and TAM, whatever is drawn") {
    const char* const asked = std::getenv("PUCKLOOP_IRCOM_RUNS");
    const int runs = asked ? std::atoi(asked) : 3;
    RandomStream random(16, "ircom");
    int could = 0, did = 0, from_tam = 0, by_robot = 0;
    for (int run = 0; run < runs; ++run) {
        const Drawn drawn = draw(random);
        const Workbench bench;
        const auto file = bench.file("drawn.toml", drawn.text);
        const Ended ended = bench.run("o", {file, "--in-process", "--threads", "1", "--no-cache"});
        INFO(drawn.text << ended.err);
        REQUIRE(ended.status == 0);
        for (const int listener : {0, 1}) {
            const int other = 1 - listener;
            const auto [right, wrong] = heard(bench, listener, drawn.words[static_cast<std::size_t>(other)]);
            CHECK(wrong <= 1);
            CHECK(right >= 2);
            could += sent(bench, fmt::format("robot{}", other), fmt::format("robot{}", listener));
            did += right;
        }
        // The TAM's word for its task, and the robot's, which the TAM reports.
        from_tam += sent(bench, "tam0", "robot2", drawn.task);
        by_robot += heard(bench, 2, drawn.task).first;
        CHECK(heard(bench, 2, drawn.task).first >= 3);
        bool reported = false;
        for (const auto& [tam, values] : values_of(bench, "o", "heard"))
            reported |= std::find(values.begin(), values.end(), fmt::format("{:02x}", drawn.words[2])) !=
                        values.end();
        CHECK(reported);
    }
    CAPTURE(could, did, from_tam, by_robot);
    CHECK(did >= 0.85 * could);
    CHECK(by_robot >= 0.85 * from_tam);
    WARN(fmt::format(
        "{} runs: robots heard each other {} times, of {} words with nothing beside them; a robot its TAM "
        "{} times, of {}",
        runs, did, could, by_robot, from_tam));
}
