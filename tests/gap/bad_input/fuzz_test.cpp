// Spoilt at random (seeded): whatever stands in the files, reading ends with an experiment or with one line.

#include "tests/gap/bad_input/made_experiment.h"
#include "tests/kit/files.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::gap;
using namespace puckloop::gap::tests;

namespace {

constexpr const char* kPieces[] = {
    ",",    ";",    "\n",      "\r\n",    "\"",       "'",      "[",     "]",    "{",    "}",
    "=",    "nan",  "inf",     "-inf",    "1e308",    "-1e308", "1e999", "-0",   "\t",   "#",
    "\xFF", "kind", "[[run]]", "file = ", "\xE2\x82", "0x7f",   "1_0",   "true", ".5.5", "   "};

/// A few cuts, copies, pieces and flipped bytes.
std::string spoilt(std::string text, RandomStream& random) {
    const std::size_t blows = 1 + random.below(6);
    for (std::size_t k = 0; k < blows && !text.empty(); ++k) {
        const std::size_t at = random.below(text.size()), length = random.below(20);
        switch (random.below(5)) {
        case 0:
            text.erase(at, length);
            break;
        case 1:
            text.insert(at, kPieces[random.below(std::size(kPieces))]);
            break;
        case 2:
            text[at] = static_cast<char>(random.below(256));
            break;
        case 3:
            text.insert(at, text.substr(random.below(text.size()), length));
            break;
        default:
            text.resize(at);
        }
    }
    return text;
}

void spoil_often(const char* file) {
    RandomStream random(1, std::string("gap/fuzz/") + file);
    std::size_t refused = 0, rounds = 0;
    for (const char* kind :
         {"proximity", "motion", "rab", "microphone", "ground", "accelerometer", "timing"}) {
        Made made = clean(kind);
        made.rows.resize(20);
        made.runs = 2;
        made.toml = "title = \"x\"\n[columns]\nt_s = { from = \"t_s\", unit = \"s\" }\n";
        if (std::string_view(kind) == "timing") made.toml = "";
        const Folder folder(made);
        REQUIRE(refusal(folder.path()) == "");
        const std::string good = puckloop::tests::text_of(folder.path() / file);
        for (int round = 0; round < 300; ++round) {
            const std::string bad = spoilt(good, random);
            write_file(folder.path() / file, bad);
            INFO(kind << " round " << round << ":\n" << bad);
            std::string said;
            REQUIRE_NOTHROW(said =
                                refusal(folder.path()));  // InputError is caught there, nothing else may come
            REQUIRE(said.find('\n') == std::string::npos);
            refused += said.empty() ? 0 : 1;
            ++rounds;
        }
    }
    CHECK(refused > rounds / 10);
    CHECK(refused < rounds);
}

}  // namespace

TEST_CASE("tables spoilt at random are read or refused") {
    spoil_often("run0.csv");
}

TEST_CASE("descriptions spoilt at random are read or refused") {
    spoil_often("experiment.toml");
}
