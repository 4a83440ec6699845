// The e-puck's real firmware on the bare chip: boot sequence, infra-red pulses, serial session.
// Expected times: fact sheet epuck.md, sections 3 and 6.1. Needs the image in $PUCKLOOP_IMAGES.

#include "emu/dspic/chip/chip.h"
#include "emu/image/image.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

using namespace puckloop;
using namespace puckloop::dspic;
using cosim::Time;

namespace {

constexpr std::uint16_t kFoscCrystalX8 = 0xFFE6;
constexpr Time kByte = 86'805'556;  // 10 bits at 115,200 baud

std::string image_path(const std::string& name) {
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    if (!folder) return {};
    const std::string path = std::string(folder) + "/" + name;
    return std::filesystem::exists(path) ? path : std::string{};
}

/// No obstacle, even light, battery full. Remembers pulses and bytes.
struct Surface : Pins {
    struct Edge {
        Time at;
        int line;
        bool level;
    };
    const Chip* chip = nullptr;
    std::vector<Edge> pulses;
    std::vector<std::pair<Time, int>> bytes;
    std::uint16_t levels_f = 0, levels_g = 0, levels_a = 0, levels_d = 0;

    void driven(PortLetter port, std::uint16_t levels, std::uint16_t, Cycle now) override {
        const auto line = [&](std::uint16_t before, int pin, int number) {
            if ((before ^ levels) >> pin & 1)
                pulses.push_back({chip->clock().time_of(now), number, (levels >> pin & 1) != 0});
        };
        if (port == PortLetter::F) {
            line(levels_f, 7, 0);
            line(levels_f, 8, 1);
            levels_f = levels;
        } else if (port == PortLetter::G) {
            line(levels_g, 0, 2);
            line(levels_g, 1, 3);
            levels_g = levels;
        } else if (port == PortLetter::A) {
            levels_a = levels;
        } else if (port == PortLetter::D) {
            levels_d = levels;
        }
    }
    std::uint16_t levels(PortLetter port, Cycle) override { return port == PortLetter::F ? 0x0002 : 0; }
    double analog(int, Cycle) override { return 3800.5 / 4096.0; }
    void uart_sent(int unit, const cosim::UartFrame& frame) override {
        bytes.emplace_back(frame.start, unit << 8 | frame.data);
    }
    void i2c_phase(int, const cosim::I2cPhase& phase) override {
        if (phase.kind != cosim::I2cPhaseKind::Stop) asked = phase;
    }
    std::optional<cosim::I2cPhase> asked;  ///< waits for the bus to answer
};

struct Robot {
    Surface surface;
    Chip chip{dspic30f6014a(), surface, {.fosc = kFoscCrystalX8}};

    explicit Robot(const std::string& image) {
        surface.chip = &chip;
        chip.load(image::load_image(image));
        chip.power_on();
    }
    /// Runs in short steps, with an empty I2C bus: nobody acknowledges, reads give 0xFF.
    void live_until(Time end) {
        while (chip.now() < end) {
            constexpr Time kStep = 50 * cosim::kMicrosecond;  // less than nine I2C clocks
            chip.run_until(std::min(end, chip.now() + kStep));
            if (!surface.asked) continue;
            const cosim::I2cPhase phase = *surface.asked;
            surface.asked.reset();
            chip.run_until(phase.start + 9 * phase.clock_period);
            const bool read = phase.kind == cosim::I2cPhaseKind::Read;
            chip.i2c_answer(1, {.kind = read ? cosim::I2cPhaseKind::Data : cosim::I2cPhaseKind::Acknowledge,
                                .byte = 0xFF});
        }
    }
    /// Bytes back to back on a UART from `start` on; returns when the last one has arrived.
    Time send(Time start, const std::vector<int>& bytes, int unit = 2) {
        for (const int byte : bytes) {
            cosim::UartFrame frame;
            frame.start = start;
            frame.bit_period = kByte / 10;
            frame.data = static_cast<std::uint16_t>(byte);
            live_until(start + 9 * frame.bit_period);
            chip.uart_receive(unit, frame);
            start += kByte;
        }
        return start;
    }
};

}  // namespace

TEST_CASE("epuck_firmware.hex boots twice, pulses its emitters and answers a session") {
    const std::string path = image_path("epuck_firmware.hex");
    if (path.empty()) {
        WARN("skipped: PUCKLOOP_IMAGES does not name a folder with epuck_firmware.hex");
        return;
    }
    Robot robot(path);
    Surface& surface = robot.surface;
    Chip& chip = robot.chip;

    // First boot: 17.63 s of nothing, then the pulse trains of the calibration.
    chip.run_until(cosim::from_seconds(19.0));
    REQUIRE(surface.pulses.size() > 16);
    const double first = cosim::to_seconds(surface.pulses[0].at);
    CHECK(first == Approx(17.63).epsilon(0.02));
    for (std::size_t i = 0; i < 8; i += 2) {
        const auto& on = surface.pulses[i];
        const auto& off = surface.pulses[i + 1];
        CHECK(on.level);
        CHECK(on.line == static_cast<int>(i / 2));
        CHECK(off.line == on.line);
        CHECK(cosim::to_seconds(off.at - on.at) * 1e6 == Approx(325.5).epsilon(0.02));
        if (i) CHECK(cosim::to_seconds(on.at - surface.pulses[i - 2].at) * 1e3 == Approx(2.44).epsilon(0.02));
    }

    // RCON.POR makes it reset itself once; then it is ready.
    chip.run_until(cosim::from_seconds(41.0));
    const ChipReport report = chip.report();
    REQUIRE(report.resets.size() == 2);
    CHECK(report.resets[1].cause == "SWR");
    CHECK(cosim::to_seconds(chip.clock().time_of(report.resets[1].cycle)) == Approx(19.8).epsilon(0.02));
    CHECK(report.traps.empty());
    CHECK(surface.bytes.empty());  // nothing unasked

    // A session: wake-up byte, configuration, 72 bytes of sensors.
    Time end = robot.send(cosim::from_seconds(41.0), {0x01, 0, 0, 0, 0});
    chip.run_until(end + 200 * cosim::kMillisecond);
    REQUIRE(surface.bytes.size() == 72);
    for (const auto& [at, byte] : surface.bytes)
        CHECK(byte >> 8 == 2);
    const auto byte = [&](std::size_t index) { return surface.bytes[index].second & 0xFF; };
    for (std::size_t i = 0; i < 24; ++i)
        CHECK(byte(i) == 0);
    CHECK(byte(24) == 1);  // battery good
    CHECK(byte(25) == 0);
    for (std::size_t i = 40; i < 56; i += 2) {
        CHECK(byte(i) == (3800 & 0xFF));
        CHECK(byte(i + 1) == (3800 >> 8));
    }
    CHECK(surface.bytes[71].first - surface.bytes[0].first == Approx(71.0 * kByte).epsilon(0.001));

    // One actuator frame: wheels +500 and -500, LED0 and LED2; the answer starts within a millisecond.
    surface.bytes.clear();
    end = robot.send(end + 300 * cosim::kMillisecond,
                     {0xF4, 0x01, 0x0C, 0xFE, 0x00, 0x00, 0x05, 0x03, 0x00, 0x00, 0x4E, 0x00});
    chip.run_until(end + 20 * cosim::kMillisecond);
    REQUIRE(surface.bytes.size() == 72);
    CHECK(surface.bytes[0].first - end < cosim::kMillisecond);
    CHECK(chip.peek("PR5") == 115);
    CHECK(chip.peek("PR4") == 115);
    CHECK((surface.levels_a & 0xF6C0) == (1u << 6 | 1u << 9));

    // The end frame is not answered.
    surface.bytes.clear();
    end = robot.send(end + 300 * cosim::kMillisecond, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x52, 0});
    chip.run_until(end + 200 * cosim::kMillisecond);
    CHECK(surface.bytes.empty());
    CHECK((surface.levels_d & 0x00FF) == 0);
}

TEST_CASE("how time is cut and whether waiting is skipped changes nothing") {
    const std::string path = image_path("epuck_firmware.hex");
    if (path.empty()) {
        WARN("skipped: PUCKLOOP_IMAGES does not name a folder with epuck_firmware.hex");
        return;
    }
    std::vector<Surface::Edge> reference;
    std::uint64_t instructions = 0;
    for (const int variant : {0, 1, 2}) {
        Robot robot(path);
        robot.chip.set_skipping(variant != 2);
        robot.chip.run_until(cosim::from_seconds(17.6));
        const Time end = cosim::from_seconds(18.0);
        if (variant == 1)
            for (Time time = robot.chip.now(); time < end; time += 37'123'457)
                robot.chip.run_until(time);
        robot.chip.run_until(end);
        const std::vector<Surface::Edge>& pulses = robot.surface.pulses;
        REQUIRE(pulses.size() > 8);
        if (variant == 0) {
            reference = pulses;
            instructions = robot.chip.report().instructions;
        }
        REQUIRE(pulses.size() == reference.size());
        for (std::size_t i = 0; i < pulses.size(); ++i)
            CHECK(pulses[i].at == reference[i].at);
        CHECK(robot.chip.report().instructions == instructions);
    }
}

TEST_CASE("an eleven-byte frame is never answered, the twelfth byte brings the answer") {
    const std::string path = image_path("epuck_firmware.hex");
    if (path.empty()) {
        WARN("skipped: PUCKLOOP_IMAGES does not name a folder with epuck_firmware.hex");
        return;
    }
    Robot robot(path);
    robot.chip.run_until(cosim::from_seconds(41.0));
    Time end = robot.send(cosim::from_seconds(41.0), {0x01, 0, 0, 0, 0});
    robot.chip.run_until(end + 200 * cosim::kMillisecond);
    robot.surface.bytes.clear();
    end = robot.send(end + 300 * cosim::kMillisecond, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x4E});
    robot.chip.run_until(end + cosim::kSecond);
    CHECK(robot.surface.bytes.empty());
    end = robot.send(end + cosim::kSecond, {0});
    robot.chip.run_until(end + 20 * cosim::kMillisecond);
    CHECK(robot.surface.bytes.size() == 72);
}

TEST_CASE("BTcom_default.hex prints its banner and answers V, C, O, N and the binary commands on UART1") {
    const std::string path = image_path("BTcom_default.hex");
    if (path.empty()) {
        WARN("skipped: PUCKLOOP_IMAGES does not name a folder with BTcom_default.hex");
        return;
    }
    Robot robot(path);
    Surface& surface = robot.surface;
    const auto text = [&] {
        std::string heard;
        for (const auto& [at, byte] : surface.bytes)
            if (byte >> 8 == 1) heard += static_cast<char>(byte);
        surface.bytes.clear();
        return heard;
    };
    robot.live_until(cosim::from_seconds(6.0));
    const std::string banner = text();
    CHECK(banner.size() == 88);
    CHECK(banner.find("WELCOME to the SerCom protocol on e-Puck\r\n") != std::string::npos);

    const auto ask = [&](const std::vector<int>& bytes) {
        const Time end = robot.send(robot.chip.now() + cosim::kMillisecond, bytes, 1);
        robot.live_until(end + 100 * cosim::kMillisecond);
        return text();
    };
    CHECK(ask({'V', '\r'}) == "v,Version 1.1.4 December 2006\r\n");
    CHECK(ask({'C', '\r'}) == "c,0\r\n");
    CHECK(ask({'O', '\r'}) == "o,3800,3800,3800,3800,3800,3800,3800,3800\r\n");
    CHECK(ask({'N', '\r'}).substr(0, 2) == "n,");
    CHECK(ask({0xB2, 0xB1, 0x00}).size() == 32);
    CHECK(ask({'?', '\r'}) == "z,Command not found\r\n");
    CHECK(robot.chip.report().traps.empty());
}
