// demoGCtronic: program/DemoGCtronic-complete/main_c.c, a program for each position of the selector.

#include "tests/images/trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace puckloop::images {

namespace {

constexpr const char* kImage = "demoGCtronic.X.production.hex";
constexpr auto kNew = pic::Revision::Rev13;

Row row(int selector, std::string says, std::function<std::string(Trial&)> see,
        pic::Revision revision = pic::Revision::Rev12, double boot = 3.8, double uart2_baud = 0.0) {
    return {kImage,
            fmt::format("selector {}{}", selector, revision == kNew ? ", board 1.3" : ""),
            std::move(says),
            {.selector = selector, .revision = revision, .boot = boot, .uart2_baud = uart2_baud},
            std::move(see)};
}

bool has(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
}

std::string falls(Trial& trial) {
    trial.heard();
    trial.set("acc_z", 2048);
    trial.run(0.1);
    const std::string reply = trial.heard();
    expect(has(reply, "Free fall"), "at 0 g: " + reply);
    expect(trial.plays(0.3) > 0.05, "no sound at 0 g");
    return "at 0 g: \"Free fall\", a sound, body LED";
}

std::string loudest(Trial& trial) {
    for (const auto& [microphone, led] : {std::pair{0, "1"}, {1, "7"}, {2, "4"}}) {
        trial.set(fmt::format("mic_level{}", microphone), 1500);
        trial.run(0.3);
        expect(trial.leds() == led, fmt::format("microphone {}: LEDs {}", microphone, trial.leds()));
        trial.set(fmt::format("mic_level{}", microphone), 0);
        trial.run(1.3);
    }
    return "LED 1, 7, 4 for the right, left, back microphone";
}

std::string wall(Trial& trial) {
    trial.run(4);
    const auto free = trial.drives(0.5);
    expect(free[0] > 50 && free[1] > 50, fmt::format("drives {}, {}", free[0], free[1]));
    return "calibrates, then drives";
}

std::string asercom(Trial& trial) {
    expect(has(trial.ask("V\r"), "v,Version"), "no version");
    expect(trial.ask("C\r") == "c,3\r\n", "C: another selector");
    expect(trial.ask("A\r").starts_with("a,"), "A: nothing");
    expect(trial.ask("D,200,-200\r") == "d\r\n", "D: nothing");
    const auto turns = trial.drives(1.0);
    expect(std::abs(turns[0] - 200) < 10 && std::abs(turns[1] + 200) < 10, "D: another speed");
    return "V, A, C, D answered, wheels turn at what D says";
}

std::string asercom13(Trial& trial) {
    trial.set("lsm330_rate_z", 50);
    trial.set("battery_v", 4.2);
    trial.run(0.1);
    int x = 0, y = 0, z = 0, raw = 0;
    expect(std::sscanf(trial.ask("g\r").c_str(), "g,%d,%d,%d", &x, &y, &z) == 3 && std::abs(z - 5714) < 350,
           "g: another rate");
    expect(std::sscanf(trial.ask("b\r").c_str(), "b,%d", &raw) == 1 && std::abs(raw - 2560) < 5,
           "b: another voltage");
    return "g and b by LSM330 and AN7";
}

/// Drives until the wheels turn against each other; how far the left one went.
double side_of(Trial& trial) {
    double length = 0.0;
    for (int i = 0; i < 100; ++i) {
        const auto there = trial.drives(0.1);
        if (there[0] < 0 && there[1] > 0) return length;
        length += there[0];
    }
    throw Wrong{"no corner"};
}

/// Turns until they run alike again; how many steps.
double corner_of(Trial& trial) {
    double steps = 0.0;
    for (int i = 0; i < 100; ++i) {
        const auto there = trial.drives(0.1);
        if (there[0] > 5) return steps;
        steps += there[1];
    }
    throw Wrong{"turns for ever"};
}

std::string square_by_steps(Trial& trial) {
    side_of(trial);
    corner_of(trial);
    const double side = side_of(trial), corner = corner_of(trial);
    expect(std::abs(side - 800) < 50, fmt::format("a side of {} steps", side));
    expect(std::abs(corner - 330) < 25, fmt::format("a corner of {} steps", corner));
    return "sides of 800 steps, corners of 330 steps to the left";
}

std::string displays(Trial& trial) {
    trial.heard();
    trial.set("proximity3", 900);
    bool lit = false;
    for (int i = 0; i < 60 && !lit; ++i) {
        trial.run(0.01);
        lit = trial.leds() == "3";
    }
    expect(lit, "proximity 3: LEDs " + trial.leds());
    expect(has(trial.heard(), "Cam light"), "no picture");
    return "LED 3 for proximity 3; \"Cam light\" of each picture";
}

std::string turns_to_light(Trial& trial) {
    trial.rig().clear_changes();
    trial.run(2.0);
    std::size_t changes = 0;
    for (int led = 0; led < 8; ++led)
        changes += trial.rig().changes(fmt::format("led{}", led)).size();
    expect(changes > 4, fmt::format("{} changes of LEDs", changes));
    return "an LED for where each picture is lightest";
}

std::string translates(Trial& trial) {
    expect(has(trial.heard(), "RS232 - I2C translator"), "no greeting");
    const std::string answer = trial.ask(std::string("\x1E\x8F", 2));
    expect(answer.size() > 20, fmt::format("{} bytes", answer.size()));
    return "greets; then a stream of bytes, for its source takes no byte for one (e_getchar_uart1 does not "
           "wait)";
}

std::string gyroscope(Trial& trial) {
    trial.set("lsm330_rate_z", 100);
    trial.run(0.3);
    expect(trial.leds() == "0 6 7", "100 deg/s to the left: LEDs " + trial.leds());
    trial.set("lsm330_rate_z", 0);
    trial.run(0.3);
    return "LEDs 0, 7, 6 at 100 deg/s to the left";
}

std::string extension(Trial& trial) {
    const std::string version = trial.ask("V\r", 2);
    expect(has(version, "v,Version"), "UART2: " + version);
    return "answers V at UART2, 230400 baud";
}

std::string configures(Trial& trial) {
    expect(has(trial.heard(2), "e-Puck Bluetooth calibration"), "no greeting");
    trial.ask("N\r", 2, 0.5);
    const std::string asked = trial.heard(1);
    expect(has(asked, "\x02\x52"), fmt::format("{} bytes for the module", asked.size()));
    return "greets at UART2, asks the Bluetooth module at UART1 (on the bench there is none)";
}

std::string tests_all(Trial& trial) {
    trial.run(7.0);
    const std::string reply = trial.heard(2);
    for (const char* part : {"Calibration finished", "ACCELEROMETER", "SELECTOR", "IR\r\n",
                             "PROXIMITY SENSORS", "AMBIENT LIGHT SENSORS", "MICROPHONE", "CAMERA"})
        expect(has(reply, part), fmt::format("no {} at UART2", part));
    return "all of its lines at UART2, pictures included";
}

std::string passes_on(Trial& trial) {
    trial.heard(2);
    trial.ask("hello", 1);
    const std::string there = trial.heard(2);
    trial.ask("world", 2);
    const std::string back = trial.heard(1);
    expect(there == "hello" && back == "world", there + ", " + back);
    return "passes bytes on both ways";
}

std::string follows(Trial& trial) {
    trial.run(3.0);
    trial.set("proximity0", 600);
    trial.set("proximity1", 600);
    const auto there = trial.drives(1.0);
    expect(std::abs(there[0]) + std::abs(there[1]) > 50, fmt::format("drives {}, {}", there[0], there[1]));
    return "calibrates, running light, drives by what is before it";
}

std::string drives_on(Trial& trial) {
    trial.run(3.0);
    const auto there = trial.drives(1.0);
    expect(std::abs(there[0]) + std::abs(there[1]) > 50, fmt::format("drives {}, {}", there[0], there[1]));
    return fmt::format("drives {}", std::abs(there[0] - there[1]) > 20 ? "a spiral" : "on");
}

/// An older build of the same, behind a boot loader.
std::vector<Row> older_rows(const char* image, const char* where) {
    std::vector<Row> rows;
    const auto add = [&](int selector, std::string says, std::function<std::string(Trial&)> see,
                         pic::Revision revision = pic::Revision::Rev12, double boot = 3.8,
                         double baud = 0.0) {
        rows.push_back(row(selector, std::move(says), std::move(see), revision, boot, baud));
        rows.back().image = image;
        rows.back().at += fmt::format(", {}", where);
    };
    add(0, "free fall and shock detection with sounds", falls);
    add(1, "says \"Locate sound\"", locates_a_clap);
    add(2, "wall following", wall);
    add(3, "sercom protocol at UART1", asercom);
    add(4, "drives a square, by steps", square_by_steps);
    add(5, "sensors on LEDs, light of the camera", displays);
    add(6, "camera points to light", turns_to_light);
    add(7, "RS232 to I2C translator", translates, kNew);
    add(8, "shows the ground's direction", shows_the_ground);
    add(9, "gyroscope on LEDs", gyroscope, kNew);
    add(10, "sercom for the extension, UART2 at 230400 baud", extension, pic::Revision::Rev12, 4.5, 230400);
    add(11, "configures the Bluetooth module, by UART2", configures);
    add(12, "test of everything, at UART2", tests_all);
    add(13, "UART1 to UART2", passes_on);
    add(14, "follows what is before it", follows);
    add(15, "dust cleaner: a spiral until something is met", drives_on);
    return rows;
}

}  // namespace

std::vector<Row> demo_gctronic_rows() {
    std::vector<Row> rows{
        row(0, "free fall and shock detection with sounds", falls),
        row(1, "LED at the loudest microphone", loudest),
        row(2, "wall following", wall),
        row(3, "advanced sercom protocol at UART1", asercom),
        row(3, "and keys of a remote control drive it", drives_by_remote),
        row(3, "the same: gyroscope, battery", asercom13, kNew),
        row(4, "drives a square, by steps", square_by_steps),
        row(4, "the same: its flag for the gyroscope is 0", square_by_steps, kNew),
        row(5, "sensors on LEDs, light of the camera", displays),
        row(6, "camera points to light", turns_to_light),
        row(7, "RS232 to I2C translator", translates, kNew),
        row(8, "shows the ground's direction", shows_the_ground),
        row(9, "gyroscope on LEDs", gyroscope, kNew),
        row(10, "sercom for the extension, UART2 at 230400 baud", extension, pic::Revision::Rev12, 4.5,
            230400),
        row(11, "configures the Bluetooth module, by UART2", configures),
        row(12, "test of everything, at UART2", tests_all),
        row(13, "UART1 to UART2", passes_on),
        row(14, "follows what is before it", follows),
        row(15, "dust cleaner: a spiral until something is met", drives_on),
    };
    for (const auto& [image, where] :
         {std::pair{"demoGCtronic-rev117+bootloader.hex", "behind a boot loader"},
          std::pair{"demoGCtronic-rev117+bootloader+EEPROM-FFF7.hex", "with an EEPROM"}})
        std::ranges::move(older_rows(image, where), std::back_inserter(rows));
    return rows;
}

}  // namespace puckloop::images
