// The real BTcom firmware on UART1: e-puck fact sheet 6.3, motors 3.5.

#include "tests/exec/rig.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using exec::Rig;
using Bytes = std::vector<std::uint8_t>;

namespace {

const std::string kBanner = "\x0C\x07WELCOME to the SerCom protocol on e-Puck\r\n"
                            "the EPFL education robot type \"H\" for help\r\n";
constexpr double kBootSeconds = 4.0;

/// What comes back within `seconds` of a line.
std::string ask(Rig& rig, const std::string& line, double seconds = 0.1) {
    rig.take(1);
    rig.send(1, Bytes(line.begin(), line.end()));
    rig.run_for(seconds);
    return rig.take_text(1);
}

Bytes ask_bytes(Rig& rig, const Bytes& command) {
    rig.take(1);
    rig.send(1, command);
    rig.run_for(0.1);
    return rig.take_bytes(1);
}

void check_ascii(Rig& rig, const std::string& version) {
    CHECK(ask(rig, "V\r") == "v," + version + "\r\n");
    CHECK(ask(rig, "v\n") == "v," + version + "\r\n");
    CHECK(ask(rig, "A\r") == "a,0,0,0\r\n");
    rig.set("acc_z", 2900);
    rig.run_for(0.05);
    CHECK(ask(rig, "A\r") == "a,0,0,52\r\n");
    rig.set("acc_z", 2848);
    CHECK(ask(rig, "C\r") == "c,0\r\n");
    rig.set("selector", 5);
    CHECK(ask(rig, "C\r") == "c,5\r\n");
    rig.set("selector", 0);
    CHECK(ask(rig, "G\r") == "g IR check : 0x2, address : 0x0, data : 0x0\r\n");
    CHECK(ask(rig, "I\r") == "i,1,40,40,8,3200\r\n");
    CHECK(ask(rig, "N\r") == "n,0,0,0,0,0,0,0,0\r\n");
    CHECK(ask(rig, "O\r") == "o,3800,3800,3800,3800,3800,3800,3800,3800\r\n");
    CHECK(ask(rig, "X,5\r").starts_with("x,11111\r\n"));
    CHECK(ask(rig, "?\r") == "z,Command not found\r\n");
    const std::string help = ask(rig, "H\r", 0.3);
    CHECK(help.starts_with("\n\"A\"         Accelerometer\r\n"));
    CHECK(help.size() > 600);
}

/// Tilt and sound: U prints volumes of 256 samples, whose range is 5.65 deviations.
void check_tilt_and_sound(Rig& rig) {
    rig.set("acc_x", 2048 + 160);
    rig.run_for(0.05);
    CHECK(ask(rig, "A\r") == "a,160,0,0\r\n");
    rig.set("acc_x", 2048);
    CHECK(ask(rig, "U\r") == "u,0,0,0\r\n");
    rig.set("mic_level2", 300);
    double sum = 0.0;
    constexpr int kAsked = 20;  // each scatters by 10 %
    for (int i = 0; i < kAsked; ++i) {
        const std::string told = ask(rig, "U\r");
        REQUIRE(told.starts_with("u,0,0,"));
        sum += std::stod(told.substr(6));
    }
    CHECK(sum / kAsked == Approx(300 * 5.65 / 5.015).epsilon(0.08));
    rig.set("mic_level2", 0);
    rig.run_for(0.05);
}

void check_leds(Rig& rig) {
    CHECK(ask(rig, "F,1\r") == "f\r\n");
    CHECK(rig.get("led_front") == 1);
    CHECK(ask(rig, "B,2\r") == "b\r\n");
    CHECK(rig.get("led_body") == 1);
    CHECK(ask(rig, "L,3,1\r") == "l\r\n");
    CHECK(rig.get("led3") == 1);
    CHECK(rig.get("led4") == 0);
    CHECK(ask(rig, "L,8,1\r") == "l\r\n");
    for (int led = 0; led < 8; ++led)
        CHECK(rig.get("led" + std::to_string(led)) == 1);
    CHECK(ask(rig, "S\r") == "s\r\n");
    for (int led = 0; led < 8; ++led)
        CHECK(rig.get("led" + std::to_string(led)) == 0);
}

void check_sensors(Rig& rig) {
    rig.set("proximity2", 321);
    rig.set("ambient6", 2500);
    rig.run_for(0.1);
    CHECK(ask(rig, "N\r") == "n,0,0,321,0,0,0,0,0\r\n");
    CHECK(ask(rig, "O\r") == "o,3800,3800,3800,3800,3800,3800,2500,3800\r\n");
    const Bytes both = ask_bytes(rig, {0xB2, 0xB1, 0x00});
    REQUIRE(both.size() == 32);
    CHECK((both[4] | both[5] << 8) == 321);
    CHECK((both[16 + 12] | both[16 + 13] << 8) == 2500);
    CHECK((both[16] | both[17] << 8) == 3800);
    rig.set("proximity2", 0);
    rig.set("ambient6", 3800);
}

/// Share of the time for which coil `name` or its complement in the phase carries current.
double on_share(const Rig& rig, double from, double to) {
    int coils = 0;
    double since = from, on = 0;
    for (const auto& change : rig.changes()) {
        if (!change.name.starts_with("left_coil_")) continue;
        if (coils > 0) on += change.time_s - since;
        since = change.time_s;
        coils += change.value == 1 ? 1 : -1;
    }
    if (coils > 0) on += to - since;
    return on / (to - from);
}

void check_motors(Rig& rig) {
    CHECK(ask(rig, "D,300,-300\r") == "d\r\n");
    CHECK(ask(rig, "E\r") == "e,300,-300\r\n");
    CHECK(ask_bytes(rig, {0xBB, 0x00}) == Bytes{0x2C, 0x01, 0xD4, 0xFE});
    const double left = rig.get("wheel_left"), right = rig.get("wheel_right"), begin = rig.now_s();
    rig.clear_changes();
    rig.run_for(5.0);
    CHECK((rig.get("wheel_left") - left) / 5 == Approx(302.9).margin(0.3));
    CHECK((rig.get("wheel_right") - right) / 5 == Approx(-302.9).margin(0.3));
    // Power save: 15 of 33 ticks with current. Bits are set one by one, hence the margin.
    CHECK(on_share(rig, begin, rig.now_s()) == Approx(15.0 / 33).margin(0.01));
    CHECK(ask(rig, "D,0,0\r") == "d\r\n");
    CHECK(ask(rig, "P,0,0\r") == "p\r\n");
    CHECK(ask(rig, "Q\r") == "q,0,0\r\n");
    CHECK(ask_bytes(rig, {0xBC, 0xF4, 0x01, 0x0C, 0xFE, 0x00}).empty());
    CHECK(ask(rig, "E\r") == "e,500,-500\r\n");
    rig.run_for(1.0);
    CHECK(ask(rig, "S\r") == "s\r\n");
    rig.run_for(0.1);
    const double before = rig.get("wheel_left");
    const std::string counters = ask(rig, "Q\r");
    CHECK(counters.starts_with("q,6"));  // 1.2 s at 500 steps/s
    rig.run_for(0.5);
    CHECK(rig.get("wheel_left") == before);
}

void check_reset(Rig& rig) {
    const std::size_t resets = rig.chip().report().resets.size();
    const std::string text = ask(rig, "R\r", kBootSeconds);
    CHECK(text.starts_with("r"));
    CHECK(text.ends_with(kBanner));
    CHECK(rig.chip().report().resets.size() == resets + 1);  // no second pass
}

void check_image(const std::string& where, const std::string& name, const std::string& version,
                 double boot_s) {
    const auto image = exec::real_image(name);
    if (!image) return;
    INFO(name);
    Rig rig(where, *image);
    rig.run_to(boot_s);
    CHECK(rig.take_text(1) == kBanner);
    CHECK(ask(rig, "V\r") == "v," + version + "\r\n");
    CHECK(ask_bytes(rig, {0xB2, 0xB1, 0x00}).size() == 32);
    CHECK(rig.chip().report().traps.empty());
}

}  // namespace

TEST_CASE("BTcom_default.hex boots twice, prints its banner and answers as on the robot") {
    const auto image = exec::real_image("BTcom_default.hex");
    if (!image) return;
    Rig rig("pic", *image);
    rig.run_to(kBootSeconds);
    CHECK(kBanner.size() == 88);
    CHECK(rig.take_text(1) == kBanner);
    const auto resets = rig.chip().report().resets;
    REQUIRE(resets.size() == 2);
    CHECK(resets[1].cause == "SWR");
    CHECK(cosim::to_seconds(rig.chip().clock().time_of(resets[1].cycle)) == Approx(0.2).margin(0.02));
    check_ascii(rig, "Version 1.1.4 December 2006");
    check_tilt_and_sound(rig);
    check_leds(rig);
    check_sensors(rig);
    check_motors(rig);
    CHECK(ask(rig, "K\r", 2.0) == "k, Starting calibration - Remove any object in sensors range\r\n"
                                  "k, Calibration finished\r\n");
    check_reset(rig);
    CHECK(rig.take(2).empty());
}

TEST_CASE("BTcom_default.hex answers on the bare chip too") {
    check_image("dspic30f6014a", "BTcom_default.hex", "Version 1.1.4 December 2006", kBootSeconds);
}

TEST_CASE("the other BTcom images print the banner and their version") {
    check_image("pic", "BTcom_floor_sensor.hex", "Version 1.1.4 December 2006", kBootSeconds);
    check_image("pic", "BTcom_floor_lis_sesnor_turret.hex", "Version 1.1.4 December 2006", kBootSeconds);
    check_image("pic", "BTcom_20_LIS_rev84.hex", "Version 2.0.0 January 2008", kBootSeconds);
}
