// Sound on the bench: what a program plays through DCI and codec is speaker.wav.

#include "bench/wav_file.h"
#include "tests/exec/command.h"
#include "tests/exec/rig.h"

#include "base/error.h"
#include "emu/image/image.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <random>

using namespace puckloop;
using exec::Workbench;

namespace {

struct Wav {
    std::uint32_t rate = 0;
    std::vector<std::int16_t> samples;
};

std::uint32_t number(const std::string& bytes, std::size_t at, int count) {
    std::uint32_t value = 0;
    for (int i = 0; i < count; ++i)
        value |=
            static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(at + static_cast<std::size_t>(i))))
            << 8 * i;
    return value;
}

Wav read_wav(const std::string& path) {
    const std::string bytes = exec::text_of(path);
    REQUIRE(bytes.size() >= 44);
    CHECK(bytes.substr(0, 4) == "RIFF");
    CHECK(number(bytes, 4, 4) == bytes.size() - 8);
    CHECK(bytes.substr(8, 8) == "WAVEfmt ");
    CHECK(number(bytes, 20, 2) == 1);
    CHECK(number(bytes, 22, 2) == 1);
    CHECK(number(bytes, 34, 2) == 16);
    CHECK(number(bytes, 40, 4) == bytes.size() - 44);
    Wav wav{number(bytes, 24, 4), {}};
    for (std::size_t at = 44; at < bytes.size(); at += 2)
        wav.samples.push_back(static_cast<std::int16_t>(number(bytes, at, 2)));
    return wav;
}

}  // namespace

TEST_CASE("a WAV file has samples at their times, silence between, and nothing where nothing sounded") {
    const Workbench bench;
    std::mt19937 random(5);
    exec::WavFile file(bench.folder + "/a.wav");
    std::vector<std::int16_t> wanted(1300, 0);
    const cosim::Time period = cosim::kSecond / 7200;
    for (std::size_t i = 20; i < wanted.size(); ++i) {
        if (i == 700) i = 1200;
        wanted[i] = static_cast<std::int16_t>(random());
        file.sample(wanted[i] / 32768.0, static_cast<cosim::Time>(i) * period + 3);
    }
    file.close();
    const Wav wav = read_wav(bench.folder + "/a.wav");
    CHECK(wav.rate == 7200);
    CHECK(wav.samples == wanted);
    exec::WavFile empty(bench.folder + "/b.wav");
    empty.close();
    CHECK_FALSE(std::filesystem::exists(bench.folder + "/b.wav"));
    exec::WavFile nowhere("/nonexistent/folder/c.wav");
    nowhere.sample(0, 0);
    CHECK_THROWS_AS(nowhere.close(), RunError);
}

// The five sounds of the library's table: first word and length (e-puck fact sheet 3.11).
TEST_CASE("BTcom plays the five sounds of its table, word for word", "[images]") {
    const auto path = exec::real_image("BTcom_default.hex");
    if (!path) return;
    struct Sound {
        std::size_t first, length;
    };
    constexpr Sound kSounds[] = {{0, 2112}, {2116, 1760}, {3878, 3412}, {7294, 3732}, {11028, 8016}};
    const Workbench bench;
    std::string script;
    for (int i = 0; i < 5; ++i)
        script += std::to_string(4 + 2 * i) + " 54 2c 3" + std::to_string(i + 1) + " 0d\n";
    const auto outcome =
        bench.run("--board pic " + *path + " --seconds 14 --uart1 script:" + bench.file("s.txt", script) +
                  " --log " + bench.folder + "/log");
    REQUIRE(outcome.status == 0);
    CHECK(outcome.out.find("unmodelled") == std::string::npos);
    const Wav wav = read_wav(bench.folder + "/log/speaker.wav");
    CHECK(wav.rate == 7200);
    // The table stands in program memory, a word in the low half of each instruction word.
    std::vector<std::int16_t> memory;
    for (const auto& [address, word] : image::load_image(*path).all_words())
        memory.push_back(static_cast<std::int16_t>(word & 0xFFFE));
    std::vector<std::int16_t> table;  // found by its second sound
    std::size_t silent = 0, from = 0;
    int heard = 0;
    for (std::size_t at = 0; at <= wav.samples.size(); ++at) {
        const bool sounds = at < wav.samples.size() && wav.samples[at] != 0;
        if (sounds) {
            if (silent > 3000 || heard == 0) {
                from = at;
                ++heard;
            }
            silent = 0;
        } else if (++silent == 3000 && heard > 0) {
            const Sound& sound = kSounds[heard - 1];
            const std::size_t length = at - 2999 - from;
            CHECK(length <= sound.length);
            CHECK(length > sound.length * 8 / 10);
            const auto found = std::search(memory.begin(), memory.end(),
                                           wav.samples.begin() + static_cast<std::ptrdiff_t>(from),
                                           wav.samples.begin() + static_cast<std::ptrdiff_t>(from + length));
            CHECK(found != memory.end());
        }
    }
    CHECK(heard == 5);
}
