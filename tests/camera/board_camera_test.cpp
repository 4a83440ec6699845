// The camera on the main board: a program samples it as the e-puck library does, VSYNC and HREF counted by
// timers 5 and 4, the data port read every eight cycles from the fifteenth behind the edge on.

#include "base/states/checkpoint.h"
#include "emu/pic/pic_node.h"
#include "tests/camera/random_picture.h"
#include "tests/kit/node_under_test.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using cosim::kMillisecond;

namespace {

constexpr int kRows = 20, kBytes = 64;
constexpr std::uint16_t kBuffer = 0x0C00;  // of kRows x kBytes; the flag behind it

// Takes kRows rows of kBytes bytes, then sets the flag; timer 1 counts on meanwhile.
const std::string kFirmware = R"(
        .org 0x003E
        .pword line
        .org 0x0040
        .pword frame
        .org 0x100
main:   mov #0x2400, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        bclr LATC, #13
        bclr TRISC, #13
        bset LATC, #13
        mov #0x0C00, w8
        mov #20, w9
        clr w10
        mov #0xFFFF, w0
        mov w0, PR1
        bset T1CON, #15
        mov #2, w0
        mov w0, T4CON
        clr TMR4
        mov #1, w1
        mov w1, PR4
        mov w0, T5CON
        clr TMR5
        mov w1, PR5
        bset IEC1, #5
        bset IEC1, #6
        bset T5CON, #15
wait:   cp0 w10
        bra z, wait
        mov #0x5A5A, w0
        mov w0, 0x1100
done:   bra done

frame:  bclr IFS1, #6
        bset T4CON, #15
        bclr T5CON, #15
        retfie

line:   bclr IFS1, #5
        clr TMR4
        mov #64, w1
        nop
        nop
        nop
        nop
        nop
        nop
        nop
next:   mov PORTD, w0
        lsr w0, #8, w0
        mov.b w0, [w8++]
        nop
        nop
        dec w1, w1
        bra nz, next
        dec w9, w9
        bra nz, out
        bclr T4CON, #15
        mov #1, w10
out:    retfie
)";

pic::PicNodeOptions with_camera(std::shared_ptr<camera::Scenery> scenery) {
    pic::PicNodeOptions options;
    options.board.name = "robot0.pic";
    options.board.adc_noise_counts = 0;
    options.i2c_linked = false;
    options.camera = camera::Fitting{};
    options.scenery = std::move(scenery);
    return options;
}

void advance(pic::PicNode& node, cosim::Time until) {
    std::vector<cosim::Message> outbox;
    node.advance(until, {}, outbox);
}

/// Out of reset, and before the first VSYNC.
constexpr cosim::Time kSetUp = 100 * cosim::kMicrosecond;

/// As if firmware had written the registers: QQVGA, 8 cycles a byte, upright, nothing automatic.
void set_up(pic::PicNode& node) {
    advance(node, kSetUp);
    const dspic::Cycle now = node.chip().cycle();
    for (const auto& [number, value] : {std::pair{0x1E, 0xCA}, {0x20, 0x33}, {0x1D, 0x20}, {0xD4, 0x0C}}) {
        cosim::I2cPhase phase;
        phase.kind = cosim::I2cPhaseKind::Start;
        phase.byte = 0xDC;
        REQUIRE(node.board().own_i2c(phase, now).answer);
        phase.kind = cosim::I2cPhaseKind::Write;
        for (const int byte : {number, value}) {
            phase.byte = static_cast<std::uint8_t>(byte);
            REQUIRE(node.board().own_i2c(phase, now).answer);
        }
        phase.kind = cosim::I2cPhaseKind::Stop;
        CHECK(node.board().own_i2c(phase, now).ours);
    }
}

std::vector<std::uint8_t> taken(pic::PicNode& node) {
    std::vector<std::uint8_t> bytes;
    for (std::uint16_t at = kBuffer; at < kBuffer + kRows * kBytes; at += 2) {
        const std::uint16_t word = node.chip().peek_data(at);
        bytes.push_back(static_cast<std::uint8_t>(word));
        bytes.push_back(static_cast<std::uint8_t>(word >> 8));
    }
    return bytes;
}

bool is_done(pic::PicNode& node) {
    return node.chip().peek_data(0x1100) == 0x5A5A;
}

/// What the library's bytes are: from the second pixel on; VSYNC rises behind the first row.
std::vector<std::uint8_t> expected(const camera::Pixels& pixels) {
    std::vector<std::uint8_t> bytes;
    for (std::uint32_t row = 0; row < kRows; ++row)
        for (std::uint32_t x = 0; x < kBytes / 2; ++x)
            for (const std::uint8_t byte : tests::rgb565(pixels, x + 1, row))
                bytes.push_back(byte);
    return bytes;
}

}  // namespace

TEST_CASE("a program that samples as the library does gets the picture, byte for byte") {
    RandomStream random(21, "camera on board");
    const camera::Pixels pixels = tests::random_pixels(random, 160, 120);
    const std::shared_ptr<camera::Scenery> scenery = camera::make_picture(pixels);
    const image::Image image = tests::assembled(dspic::dspic30f6014a(), kFirmware);
    std::uint64_t cycles_skipping = 0;
    for (const bool skip : {true, false}) {
        pic::PicNodeOptions options = with_camera(scenery);
        options.skip_idle = skip;
        pic::PicNode node(image, options);
        set_up(node);
        for (const cosim::Time cut : tests::random_cuts(random, 5 * kMillisecond, 300 * kMillisecond))
            if (cut > kSetUp) advance(node, cut);
        REQUIRE(is_done(node));
        CHECK((taken(node) == expected(pixels)));
        CHECK(node.board().camera()->frames().size() == 1);
        if (skip)
            cycles_skipping = node.chip().cycle();
        else
            CHECK(node.chip().cycle() == cycles_skipping);
    }
}

TEST_CASE("a board goes back, and on from a saved state, in the middle of a picture") {
    RandomStream random(22, "camera on board");
    const camera::Pixels pixels = tests::random_pixels(random, 160, 120);
    const std::shared_ptr<camera::Scenery> scenery = camera::make_picture(pixels);
    const image::Image image = tests::assembled(dspic::dspic30f6014a(), kFirmware);
    pic::PicNode node(image, with_camera(scenery));
    set_up(node);
    cosim::Time now = kSetUp;
    while (node.board().camera()->frames().empty())
        advance(node, now += 100 * cosim::kMicrosecond);
    advance(node, now += static_cast<cosim::Time>(random.below(800)) * cosim::kMicrosecond);
    REQUIRE_FALSE(is_done(node));

    std::vector<std::uint8_t> state;
    StateWriter writer(state);
    node.state(writer);
    pic::PicNode other(image, with_camera(camera::make_test_pattern()));  // of which nothing may be seen
    StateReader reader(state);
    other.state(reader);
    reader.end();

    const cosim::Time end = now + 100 * kMillisecond;
    node.rewindable()->mark();
    advance(node, end);
    CHECK((taken(node) == expected(pixels)));
    node.rewindable()->rewind();
    node.rewindable()->settle();
    CHECK_FALSE(is_done(node));
    for (pic::PicNode* each : {&node, &other}) {
        advance(*each, end);
        CHECK(is_done(*each));
        CHECK((taken(*each) == expected(pixels)));
        CHECK(each->board().camera()->frames().size() == 1);
    }
}

TEST_CASE("on a linked bus the camera answers as a device, when its eighth clock ends") {
    const image::Image image = tests::assembled(dspic::dspic30f6014a(), kFirmware);
    pic::PicNodeOptions options = with_camera(camera::make_test_pattern());
    options.i2c_linked = true;
    options.fastest_i2c_hertz = 100e3;
    pic::PicNode node(image, options);
    advance(node, kSetUp);
    const cosim::PortIndex port = node.camera_bus_port();
    REQUIRE(node.ports()[port].name == "camera_i2c");
    CHECK(node.earliest_output(port) == cosim::kNever);
    CHECK(node.lookahead(port) == 5 * cosim::kMicrosecond);
    constexpr cosim::Time kClock = 12 * cosim::kMicrosecond;
    cosim::Time now = kSetUp;
    using Kind = cosim::I2cPhaseKind;
    const auto asked = [&](Kind kind, unsigned byte) {
        cosim::I2cPhase phase;
        phase.kind = kind;
        phase.byte = static_cast<std::uint8_t>(byte);
        phase.start = now;
        phase.clock_period = kClock;
        const cosim::Message message{now + 75 * cosim::kMicrosecond, port, phase};
        std::vector<cosim::Message> outbox;
        node.advance(now += 20 * kClock, std::span(&message, 1), outbox);
        std::erase_if(outbox, [&](const cosim::Message& out) { return out.port != port; });
        if (kind == Kind::Stop) {
            CHECK(outbox.empty());
            return cosim::I2cPhase{};
        }
        REQUIRE(outbox.size() == 1);
        CHECK(outbox[0].time == phase.start + 8 * kClock);
        return std::get<cosim::I2cPhase>(outbox[0].payload);
    };
    CHECK(asked(Kind::Start, 0xC0).ack == 0);  // somebody else is meant
    asked(Kind::Stop, 0);
    CHECK(asked(Kind::Start, 0xDC).ack == 1);
    CHECK(asked(Kind::Write, 0x5C).ack == 1);
    CHECK(asked(Kind::Write, 0x37).ack == 1);
    asked(Kind::Stop, 0);
    CHECK(node.board().camera()->peek(0, 0x5C) == 0x37);
    CHECK(asked(Kind::Start, 0xDC).ack == 1);
    CHECK(asked(Kind::Write, 0x5C).ack == 1);
    CHECK(asked(Kind::Start, 0xDD).ack == 1);
    const cosim::I2cPhase data = asked(Kind::Read, 0);
    CHECK(data.kind == Kind::Data);
    CHECK(data.byte == 0x37);
    asked(Kind::Stop, 0);
}

TEST_CASE("a camera that nobody listens to costs no events") {
    const std::shared_ptr<camera::Scenery> scenery = camera::make_test_pattern();
    const image::Image image = tests::assembled(dspic::dspic30f6014a(), R"(
        .org 0x100
main:   bclr TRISC, #13
        bset LATC, #13
wait:   bra wait
)");
    std::uint64_t instructions[2];
    for (const bool fitted : {false, true}) {
        pic::PicNodeOptions options = with_camera(scenery);
        if (!fitted) options.camera.reset();
        pic::PicNode node(image, options);
        advance(node, cosim::kSecond);
        instructions[fitted ? 1 : 0] = node.chip().report().instructions;
        if (fitted) CHECK(node.board().camera()->running());
    }
    CHECK(instructions[0] == instructions[1]);
}
