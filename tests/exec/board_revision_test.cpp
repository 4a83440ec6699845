// demoGCtronic, whose library probes for the LSM330, on both revisions of the board: its answers at UART1
// (selector 3) and the accelerometer's and gyroscope's demonstrations. Source: its Asercom.c and e_acc.c.

#include "tests/exec/rig.h"

#include <catch2/catch.hpp>

#include <cstdio>

using namespace puckloop;
using exec::Rig;

namespace {

constexpr const char* kImage = "demoGCtronic-rev117+bootloader.hex";
constexpr double kBootSeconds = 3.8;

std::string ask(Rig& rig, const std::string& line) {
    rig.take(1);
    rig.send(1, {line.begin(), line.end()});
    rig.run_for(0.1);
    return rig.take_text(1);
}

std::array<int, 3> three(const std::string& answer, char letter) {
    std::array<int, 3> values{-9999, -9999, -9999};
    REQUIRE(answer.size() > 2);
    CHECK(answer[0] == letter);
    CHECK(std::sscanf(answer.c_str() + 2, "%d,%d,%d", &values[0], &values[1], &values[2]) == 3);
    return values;
}

Rig booted(pic::Revision revision, int selector, const std::string& image) {
    Rig rig("pic", image, revision);
    rig.set("selector", selector);
    rig.run_for(kBootSeconds);
    return rig;
}

}  // namespace

TEST_CASE("demoGCtronic finds the accelerometer of either board revision, gyroscope and battery of 1.3") {
    const auto image = exec::real_image(kImage);
    if (!image) return;
    Rig old = booted(pic::Revision::Rev12, 3, *image);
    old.set("acc_x", 2048 + 400);
    old.run_for(0.05);
    CHECK(three(ask(old, "A\r"), 'a') == std::array{2448, 2048, 2848});
    CHECK(ask(old, "b\r") == "b,1\r\n");
    CHECK(ask(old, "g\r") == "g,0,0,0\r\n");
    old.set("battery_v", 3.3);
    CHECK(ask(old, "b\r") == "b,0\r\n");

    Rig fresh = booted(pic::Revision::Rev13, 3, *image);
    fresh.set("lsm330_acc_x", 0.5);
    fresh.set("lsm330_acc_y", -0.25);
    fresh.set("lsm330_rate_z", 100);
    fresh.run_for(0.05);
    ask(fresh, "A\r");  // shows what it read last
    const auto acceleration = three(ask(fresh, "A\r"), 'a');
    // 1 g is 1024 - 256 counts; x and y change places; noise is 4 mg.
    CHECK(acceleration[0] == Approx(2048 - 0.25 * 768).margin(14));
    CHECK(acceleration[1] == Approx(2048 + 0.5 * 768).margin(14));
    CHECK(acceleration[2] == Approx(2048 + 768).margin(14));
    const auto turning = three(ask(fresh, "g\r"), 'g');
    // Its low bytes are signed: a digit of the high byte may be missing.
    CHECK(turning[2] == Approx(100 / 8.75e-3).margin(350));
    CHECK(std::abs(turning[0]) < 350);
    fresh.set("battery_v", 3.8);
    fresh.run_for(0.05);
    int raw = 0, percent = 0;
    CHECK(std::sscanf(ask(fresh, "b\r").c_str(), "b,%d (%d%%)", &raw, &percent) == 2);
    CHECK(raw == Approx(2315).margin(3));
    CHECK(percent == Approx(50).margin(1));
    CHECK(fresh.chip().report().unmodelled.empty());
}
