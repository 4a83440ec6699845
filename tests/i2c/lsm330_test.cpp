// The LSM330 register by register, as a master on its bus finds it.

#include "emu/i2c_devices/lsm330.h"

#include "base/json.h"
#include "emu/i2c_devices/signals.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>
#include <vector>

using namespace puckloop;
using cosim::kMillisecond;
using cosim::Time;
using i2c_devices::kAcceleration;
using i2c_devices::kTurnRate;
using i2c_devices::Lsm330;

namespace {

struct Bench {
    Lsm330 device;
    Time now = 0;
    Bench(Lsm330::Die die, std::uint64_t seed = 1) : device(die, seed, "i2c") {}

    void write(std::uint8_t number, std::uint8_t value) {
        CHECK(device.start(false, now).acknowledge);
        CHECK(device.write(number, now).acknowledge);
        CHECK(device.write(value, now).acknowledge);
        device.stop(now, {});
    }
    std::vector<std::uint8_t> read(std::uint8_t number, std::size_t count = 1) {
        CHECK(device.start(false, now).acknowledge);
        CHECK(device.write(number, now).acknowledge);
        CHECK(device.start(true, now).acknowledge);
        std::vector<std::uint8_t> bytes;
        for (std::size_t i = 0; i < count; ++i)
            bytes.push_back(device.read(now).byte);
        device.stop(now, {});
        return bytes;
    }
    std::array<int, 3> axes() {
        const auto bytes = read(0xA8, 6);
        std::array<int, 3> values{};
        for (std::size_t i = 0; i < 3; ++i)
            values[i] = static_cast<std::int16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8);
        return values;
    }
    void feel(std::uint16_t first, const std::array<double, 3>& values) {
        for (std::uint16_t i = 0; i < 3; ++i)
            device.signal_at(static_cast<std::uint16_t>(first + i), values[i], now);
    }
    /// Mean and standard deviation of the z axis over `samples`.
    std::pair<double, double> z(int samples, Time period) {
        double sum = 0, squares = 0;
        for (int i = 0; i < samples; ++i) {
            now += period;
            const double value = axes()[2];
            sum += value;
            squares += value * value;
        }
        const double mean = sum / samples;
        return {mean, std::sqrt(squares / samples - mean * mean)};
    }
};

constexpr std::uint8_t kAll1600 = 0x97, kAll760 = 0xCF;
constexpr Time k1600 = 625 * cosim::kMicrosecond;

}  // namespace

TEST_CASE("both dies of the LSM330 identify themselves, sleep at first and keep what is written") {
    Bench a(Lsm330::Die::Accelerometer), g(Lsm330::Die::Gyroscope);
    CHECK(a.device.listens_to(0x1E));
    CHECK(g.device.listens_to(0x6A));
    CHECK_FALSE(a.device.listens_to(0x6A));
    CHECK_FALSE(g.device.listens_to(0x1E));
    CHECK(a.read(0x0F) == std::vector<std::uint8_t>{0x40});
    CHECK(g.read(0x0F) == std::vector<std::uint8_t>{0xD4});
    a.now = g.now = 1000 * kMillisecond;
    for (Bench* bench : {&a, &g}) {
        CHECK(bench->read(0x20) == std::vector<std::uint8_t>{0x07});
        CHECK(bench->read(0x27) == std::vector<std::uint8_t>{0x00});
        CHECK(bench->axes() == std::array<int, 3>{0, 0, 0});
        bench->write(0x0F, 0x55);  // read only
        bench->write(0x28, 0x55);
        bench->write(0x22, 0x5A);
        CHECK(bench->read(0x22) == std::vector<std::uint8_t>{0x5A});
        CHECK(bench->axes()[0] == 0);
    }
    CHECK(a.read(0x0F) == std::vector<std::uint8_t>{0x40});
    const auto report = nlohmann::json::parse(g.device.report());
    CHECK(report["without_effect"] == nlohmann::json{"CTRL_REG3_G"});
    CHECK(report["samples"] == 0);
    g.device.reset({});
    CHECK(g.read(0x22) == std::vector<std::uint8_t>{0x00});
}

TEST_CASE("sub-addresses count up by ADD_INC in the accelerometer and by their top bit in the gyroscope") {
    Bench a(Lsm330::Die::Accelerometer), g(Lsm330::Die::Gyroscope);
    CHECK(a.read(0x0D, 3) == std::vector<std::uint8_t>{0x00, 0x00, 0x40});
    a.write(0x25, 0x00);
    CHECK(a.read(0x8F, 3) == std::vector<std::uint8_t>{0x40, 0x40, 0x40});
    CHECK(g.read(0x0F, 2) == std::vector<std::uint8_t>{0xD4, 0xD4});
    CHECK(g.read(0x8F, 2) == std::vector<std::uint8_t>{0xD4, 0x00});
}

TEST_CASE("what the LSM330 feels comes at its scale, clipped, with its data sheet's noise") {
    std::mt19937 random(7);
    for (const auto& [bits, full] :
         {std::pair{0x00, 2.0}, {0x08, 4.0}, {0x10, 6.0}, {0x18, 8.0}, {0x20, 24.0}}) {
        Bench a(Lsm330::Die::Accelerometer, random());
        a.write(0x20, kAll1600);
        a.write(0x24, static_cast<std::uint8_t>(bits));
        const double g = std::uniform_real_distribution(-1.9, 1.9)(random);
        a.feel(kAcceleration, {0, 0, g});
        const auto [mean, sd] = a.z(400, k1600);
        const double digit = full / 32768;
        const double rms = 150e-6 * std::sqrt(800.0) / digit;
        CHECK(mean == Approx(g / digit).margin(4 * rms / 20 + 0.5));
        CHECK(sd == Approx(rms).epsilon(0.2).margin(0.5));
        a.feel(kAcceleration, {-30, 30, g});
        a.now += k1600;
        CHECK(a.axes()[0] == -32768);
        CHECK(a.axes()[1] == 32767);
    }
    for (const auto& [bits, digit] :
         {std::pair{0x00, 8.75e-3}, {0x10, 17.5e-3}, {0x20, 70e-3}, {0x30, 70e-3}}) {
        Bench g(Lsm330::Die::Gyroscope, random());
        g.write(0x20, kAll760);
        g.write(0x23, static_cast<std::uint8_t>(bits));
        const double rate = std::uniform_real_distribution(-240.0, 240.0)(random);
        g.feel(kTurnRate, {0, 0, rate});
        const auto [mean, sd] = g.z(400, 2 * kMillisecond);
        const double rms = 0.03 * std::sqrt(30.0) / digit;
        CHECK(mean == Approx(rate / digit).margin(4 * rms / 20 + 0.5));
        CHECK(sd == Approx(rms).epsilon(0.2).margin(0.5));
    }
}

TEST_CASE("a sample shows what was felt at its instant, and the status what is new or lost") {
    Bench a(Lsm330::Die::Accelerometer);
    a.write(0x20, 0x67);  // 100 Hz from now on
    a.feel(kAcceleration, {1.0, 0, 0});
    a.now = 9 * kMillisecond;
    CHECK(a.read(0x27)[0] == 0x00);
    a.now = 11 * kMillisecond;
    a.feel(kAcceleration, {-1.0, 0, 0});  // after the sample at 10 ms
    a.now = 12 * kMillisecond;
    CHECK(a.read(0x27)[0] == 0x0F);
    CHECK(a.axes()[0] > 15000);
    CHECK(a.read(0x27)[0] == 0x00);
    a.now = 20 * kMillisecond;
    CHECK(a.axes()[0] < -15000);
    a.now = 40 * kMillisecond;  // two more, one of them lost
    CHECK(a.read(0x27)[0] == 0xFF);
    CHECK(nlohmann::json::parse(a.device.report())["samples"] == 4);
    a.read(0xA8, 2);
    CHECK(a.read(0x27)[0] == 0xE6);
    a.write(0x20, 0x07);  // asleep
    a.now = 1000 * kMillisecond;
    CHECK(nlohmann::json::parse(a.device.report())["samples"] == 4);
    a.write(0x20, 0x64);  // z only
    a.now += 10 * kMillisecond;
    a.axes();
    a.now += 10 * kMillisecond;
    CHECK((a.read(0x27)[0] & 0x0F) == 0x04);
}

TEST_CASE("with block data update a half-read axis waits for its other half") {
    for (const bool block : {false, true}) {
        Bench a(Lsm330::Die::Accelerometer);
        a.write(0x20, block ? 0x6F : 0x67);
        a.feel(kAcceleration, {1.5, 0, 0});
        a.now = 10 * kMillisecond;
        const std::uint8_t low = a.read(0x28)[0];
        a.feel(kAcceleration, {-1.5, 0, 0});
        a.now = 20 * kMillisecond;
        const auto value = static_cast<std::int16_t>(low | a.read(0x29)[0] << 8);
        CHECK((value > 20000) == block);
        a.now = 30 * kMillisecond;
        CHECK(a.axes()[0] < -20000);
    }
    Bench g(Lsm330::Die::Gyroscope);  // big end first
    g.write(0x20, kAll760);
    g.write(0x23, 0x40);
    g.feel(kTurnRate, {200, 0, 0});
    g.now = 10 * kMillisecond;
    const auto bytes = g.read(0xA8, 2);
    CHECK((bytes[0] << 8 | bytes[1]) * 8.75e-3 == Approx(200).margin(2));
}
