// The project's firmware under sanitizers: drawn inputs find nothing, runs repeat, and a planted fault is
// found.

#include "tests/kit/shell.h"

#include <catch2/catch.hpp>

#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

using namespace puckloop;

namespace {

tests::Ran run(const std::string& command) {
    return tests::run_in_shell("ASAN_OPTIONS=detect_leaks=0 " + command);
}

/// The numbers of one line of the driver's: characters sent, and what else was seen.
struct Seen {
    std::string hash;
    unsigned long characters = 0, others = 0;
};
std::vector<Seen> lines(const std::string& text) {
    std::vector<Seen> all;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line.substr(line.rfind(": ") + 2));
        std::string word;
        Seen seen;
        words >> seen.hash >> seen.characters >> word >> seen.others;
        all.push_back(seen);
    }
    return all;
}

std::string hosted(const std::string& name) {
    return PUCKLOOP_HOSTED "/" + name + "_hosted";
}

std::string input_file(const std::string& bytes) {
    std::string path = "/tmp/puckloop_hosted_XXXXXX";
    const int file = ::mkstemp(path.data());
    REQUIRE(file >= 0);
    ::close(file);
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
}

}  // namespace

TEST_CASE("drawn inputs find nothing in the project's firmware") {
    const auto seed = std::to_string(Catch::rngSeed());
    for (const auto& [name, inputs] : {std::pair{"epuck_ircom", 60}, {"rab", 40}, {"tam", 25}}) {
        const tests::Ran outcome =
            run(hosted(name) + " --seed " + seed + " --inputs " + std::to_string(inputs));
        INFO(name << " --seed " << seed << "\n" << outcome.output.substr(0, 3000));
        REQUIRE(outcome.status == 0);
        const auto all = lines(outcome.output);
        REQUIRE(all.size() == static_cast<std::size_t>(inputs));
        unsigned long answering = 0;
        for (const Seen& seen : all)
            answering += seen.characters > 0 && seen.others > 0 ? 1 : 0;
        CHECK(answering * 4 > static_cast<unsigned long>(inputs) * 3);  // the firmware takes part
    }
}

TEST_CASE("a session on the host has the records of the protocol") {
    // Wait until it has started; a program's start; three records that drive; silence.
    std::vector<int> input{1, 3, 4 | 9 << 3};
    for (const int speed : {10, 90, 196})
        input.insert(input.end(), {2, speed, 1, speed, 0, 4 | 19 << 3});
    const std::string bytes(input.begin(), input.end());
    const std::string file = input_file(bytes);
    const tests::Ran outcome = run(hosted("epuck_ircom") + " " + file);
    ::unlink(file.c_str());
    INFO(outcome.output);
    REQUIRE(outcome.status == 0);
    const auto all = lines(outcome.output);
    REQUIRE(all.size() == 1);
    CHECK(all[0].characters == 4u * 72u);
    CHECK(all[0].others > 40);  // wheels' steps, LEDs
}

TEST_CASE("a planted fault is found, with its place") {
    // A frame of the radio module's that is longer than any, with a good check.
    std::string bytes{1};
    for (int i = 0; i < 6; ++i)
        bytes += std::string(1, static_cast<char>(2 | 31 << 3)) + std::string(47, 'x');
    const std::string file = input_file(bytes);
    const tests::Ran sound = run(hosted("tam") + " " + file);
    const tests::Ran planted = run(PUCKLOOP_PLANTED " " + file);
    ::unlink(file.c_str());
    CHECK(sound.status == 0);
    INFO(planted.output.substr(0, 2000));
    CHECK(planted.status != 0);
    CHECK(planted.output.find("planted_radio.c") != std::string::npos);
    CHECK(planted.output.find("runtime error") != std::string::npos);
}

TEST_CASE("an input that cannot be read is one line and status 2") {
    const tests::Ran outcome = run(hosted("rab") + " /nonexistent/input");
    CHECK(outcome.status == 2);
    CHECK(outcome.output == "puckloop: /nonexistent/input: cannot be read\n");
}
