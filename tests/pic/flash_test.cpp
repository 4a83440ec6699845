// `flash`: another image into the chip of a board that runs. One program blinks an LED each millisecond, the
// other one each two; both leave a word of RAM alone that the first one has counted in.

#include "tests/kit/board_faults.h"

#include "base/error.h"
#include "base/json.h"
#include "base/random.h"
#include "base/states/archive.h"
#include "emu/image/intel_hex.h"
#include "emu/pic/pic_node.h"
#include "tests/kit/node_under_test.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <map>

using namespace puckloop;
using cosim::FaultSpec;
using cosim::kMillisecond;
using cosim::Message;
using cosim::Time;
using tests::board_fault;

namespace {

constexpr Time kFlashAt = 20 * kMillisecond + 300 * cosim::kMicrosecond, kUntil = 40 * kMillisecond;
constexpr std::uint16_t kCounter = 0x0900;
constexpr std::uint32_t kOldOnly = 0x300;  // a word that the second image has not

/// `period`: cycles of 67.8 ns from one change of the LED to the next. `counts`: in RAM.
std::string blinker(int period, bool counts) {
    return fmt::format(R"(
        .org 0x001A
        .pword step
        .org 0x100
main:   mov #0x1000, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        bclr TRISA, #6
        mov #{}, w0
        mov w0, PR1
        bset IEC0, #3
        bset T1CON, #15
wait:   bra wait
        .org 0x200
step:   bclr IFS0, #3
        btg LATA, #6
        {}
        retfie
)",
                       period, counts ? "inc 0x0900" : "nop");
}

image::Image first_image() {
    return tests::assembled(dspic::dspic30f6014a(),
                            blinker(14744, true) + "        .org 0x300\n        nop\n");
}

std::string second_file() {
    static const std::filesystem::path file = tests::scratch_path("flash_second.hex");
    const image::Image second = tests::assembled(dspic::dspic30f6014a(), blinker(29488, false));
    std::ofstream(file) << image::write_dspic_hex({second.program.begin(), second.program.end()});
    return file.string();
}

FaultSpec flash_at(Time at, const std::string& file) {
    FaultSpec spec = board_fault("flash");
    spec.set("image", file);
    spec.begin = at;
    spec.count = 1;
    return spec;
}

std::unique_ptr<pic::PicNode> made(const std::vector<FaultSpec>& specs) {
    pic::PicNodeOptions options;
    options.board.name = "robot0.pic";
    options.i2c_linked = false;
    for (std::size_t i = 0; i < specs.size(); ++i)
        options.faults.push_back(tests::carried(specs[i], i));
    return std::make_unique<pic::PicNode>(first_image(), options);
}

std::vector<Time> toggles(const std::vector<Message>& out) {
    std::vector<Time> times;
    for (const Message& message : out)
        if (const auto* signal = std::get_if<cosim::Signal>(&message.payload);
            signal && signal->id == pic::kLed)
            times.push_back(message.time);
    return times;
}

bool same(const std::vector<Message>& a, const std::vector<Message>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Message& x, const Message& y) {
        return x.time == y.time && x.port == y.port && x.payload == y.payload;
    });
}

}  // namespace

TEST_CASE("an image that is flashed runs from then on, and RAM is what it was") {
    auto node = made({flash_at(kFlashAt, second_file())});
    std::vector<Message> out;
    node->advance(kFlashAt, {}, out);
    const std::uint16_t counted = node->chip().peek_data(kCounter);
    CHECK(counted == 20);
    CHECK(node->chip().memory().contains(kOldOnly));
    node->advance(kUntil, {}, out);
    CHECK(node->chip().peek_data(kCounter) == counted);
    CHECK_FALSE(node->chip().memory().contains(kOldOnly));  // erased
    const std::vector<Time> times = toggles(out);
    std::map<Time, int> periods;  // whole milliseconds
    for (std::size_t i = 1; i < times.size(); ++i)
        if (times[i - 1] > kFlashAt || times[i] < kFlashAt)
            ++periods[(times[i] - times[i - 1] + kMillisecond / 2) / kMillisecond];
    CHECK(periods.at(1) >= 18);
    CHECK(periods.at(2) >= 8);
    CHECK(periods.size() == 2);
    const auto report = nlohmann::json::parse(node->finish());
    CHECK(report.at("resets").back().at("cause") == "EXTR");
    CHECK(report.at("faults").at(0).at("fired") == 1);
}

TEST_CASE("a board that is flashed goes back and is saved like any other") {
    RandomStream random(4, "flash cuts");
    const std::vector<FaultSpec> specs{flash_at(kFlashAt, second_file())};
    auto straight = made(specs);
    std::vector<Message> all;
    straight->advance(kUntil, {}, all);
    for (int round = 0; round < 8; ++round) {
        const Time mark = 15 * kMillisecond + static_cast<Time>(random.below(10 * kMillisecond));
        auto node = made(specs);
        std::vector<Message> out;
        node->advance(mark, {}, out);
        node->rewindable()->mark();
        std::vector<Message> undone;
        node->advance(mark + 8 * kMillisecond, {}, undone);
        node->rewindable()->rewind();
        node->rewindable()->settle();
        std::vector<std::uint8_t> bytes;
        StateWriter writer(bytes);
        const cosim::StatefulNode& saved = *node;
        saved.state(writer);
        auto resumed = made(specs);
        StateReader reader(bytes);
        resumed->state(reader);
        std::vector<Message> rest = out;
        node->advance(kUntil, {}, out);
        resumed->advance(kUntil, {}, rest);
        INFO(mark);
        CHECK(same(out, all));
        CHECK(same(rest, all));
    }
}

TEST_CASE("what is no image for the chip is refused before the board runs") {
    CHECK_THROWS_AS(made({flash_at(kFlashAt, "/nowhere/a.hex")}), InputError);
    const std::filesystem::path text = tests::scratch_path("flash_text");
    std::ofstream(text) << "no image\n";
    CHECK_THROWS_AS(made({flash_at(kFlashAt, text.string())}), InputError);
    FaultSpec other = flash_at(kFlashAt, second_file());
    other.set("sha256", std::string(64, '0'));
    CHECK_THROWS_WITH(made({other}), Catch::Contains("another image than the one that was flashed"));
    // Of a chip with more flash.
    const std::filesystem::path large = tests::scratch_path("flash_large.hex");
    std::ofstream(large) << image::write_dspic_hex({{0, 0x040100}, {0x2A000, 0x000000}});
    CHECK_THROWS_AS(made({flash_at(kFlashAt, large.string())}), InputError);
}
