// BTcom: program/BTcom/BTcom.c, the SerCom protocol at UART1; its builds differ in what they have on board.

#include "tests/images/trial.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::images {

namespace {

constexpr double kBoot = 4.5;

Row row(const char* image, std::string command, std::string says, std::function<std::string(Trial&)> see) {
    return {image, std::move(command), std::move(says), {.boot = kBoot}, std::move(see)};
}

/// The answer to `command` begins so.
Row answers(const char* image, const std::string& command, std::string says, const std::string& begins) {
    return row(image, command, std::move(says), [command, begins](Trial& trial) {
        const std::string reply = trial.ask(command + "\r", 1, 0.4);
        expect(reply.starts_with(begins), reply.substr(0, 60));
        const std::string line = begins.substr(begins.find_first_not_of('\n'));
        return fmt::format("`{}`", line.substr(0, line.find_first_of("\r\n")));
    });
}

std::string calibrates(Trial& trial) {
    const std::string reply = trial.ask("K\r", 1, 4.0);
    expect(reply.find("k, Calibration finished") != std::string::npos, reply.substr(0, 80));
    return "`k, Calibration finished`";
}

std::string drives(Trial& trial) {
    expect(trial.ask("D,300,-300\r") == "d\r\n", "no answer");
    const auto there = trial.drives(1.0);
    expect(std::abs(there[0] - 303) < 6 && std::abs(there[1] + 303) < 6,
           fmt::format("{}, {}", there[0], there[1]));
    expect(trial.ask("E\r") == "e,300,-300\r\n", "E: another speed");
    expect(trial.ask("S\r") == "s\r\n", "S: no answer");
    const auto stopped = trial.drives(0.5);
    expect(stopped[0] == 0 && stopped[1] == 0, "S: goes on");
    return "wheels turn as asked, E says so, S stops them";
}

std::string lights(Trial& trial) {
    expect(trial.ask("L,3,1\r") == "l\r\n" && trial.leds() == "3", "L: LEDs " + trial.leds());
    expect(trial.ask("F,1\r") == "f\r\n" && trial.rig().get("led_front") == 1, "F");
    expect(trial.ask("B,1\r") == "b\r\n" && trial.rig().get("led_body") == 1, "B");
    return "LED 3, front and body LED light";
}

std::string sings(Trial& trial) {
    trial.rig().send(1, {'T', ',', '1', '\r'});
    const double loud = trial.plays(0.5);
    expect(loud > 0.05, fmt::format("speaker at {}", loud));
    return "sound 1 at the speaker";
}

std::string takes_picture(Trial& trial) {
    const std::string reply = trial.ask(std::string("\xB7\0", 2), 1, 3.0);
    expect(reply.size() == 3 + 3200, fmt::format("{} bytes", reply.size()));
    expect(reply.substr(0, 3) == std::string("\x01\x28\x28", 3), "another header");
    std::array<bool, 256> seen{};
    for (const char byte : reply.substr(3))
        seen[static_cast<unsigned char>(byte)] = true;
    expect(std::count(seen.begin(), seen.end(), true) > 10, "a picture of one colour");
    return "3 bytes and a picture of 40 x 40, 3200 bytes";
}

std::string restarts(Trial& trial) {
    const std::string reply = trial.ask("R\r", 1, kBoot);
    expect(reply.find("WELCOME to the SerCom protocol") != std::string::npos, reply.substr(0, 60));
    return "`r`, then its greeting";
}

std::string binary(Trial& trial) {
    expect(trial.ask("\xB2\xB1" + std::string(1, '\0')).size() == 32, "N and O: not 32 bytes");
    expect(trial.ask(std::string("\x9F\0", 2)).size() == 6, "a: not 6 bytes");
    expect(trial.ask(std::string("\xAF\0", 2)).size() == 4, "Q: not 4 bytes");
    return "N and O 32 bytes, a 6, Q 4";
}

}  // namespace

std::vector<Row> btcom_rows() {
    constexpr const char* kDefault = "BTcom_default.hex";
    std::vector<Row> rows{
        answers(kDefault, "A", "accelerometer", "a,0,0,0\r\n"),
        answers(kDefault, "C", "selector", "c,0\r\n"),
        row(kDefault, "D E S", "motors", drives),
        row(kDefault, "L F B", "LEDs", lights),
        answers(kDefault, "G", "remote control", "g IR check : 0x2, address : 0x0, data : 0x0\r\n"),
        row(kDefault, "remote control", "its keys drive the robot, address 0 or 8", drives_by_remote),
        answers(kDefault, "H", "help", "\n\"A\"         Accelerometer\r\n"),
        answers(kDefault, "I", "camera's settings", "i,1,40,40,8,3200\r\n"),
        row(kDefault, "I, binary", "a picture", takes_picture),
        answers(kDefault, "J,0,20,20,8", "sets the camera", "j\r\n"),
        row(kDefault, "K", "calibrates proximity", calibrates),
        answers(kDefault, "M", "floor sensors; this build has none", "m,0,0,0\r\n"),
        answers(kDefault, "N", "proximity", "n,"),
        answers(kDefault, "O", "ambient light", "o,3800,3800,3800,3800,3800,3800,3800,3800\r\n"),
        answers(kDefault, "P,5,6", "sets step counters", "p\r\n"),
        answers(kDefault, "Q", "step counters", "q,0,0\r\n"),
        row(kDefault, "R", "resets", restarts),
        row(kDefault, "T,1", "plays a sound", sings),
        answers(kDefault, "U", "volumes", "u,"),
        answers(kDefault, "V", "version", "v,Version 1.1.4 December 2006\r\n"),
        answers(kDefault, "X,5", "five 1", "x,11111\r\n"),
        answers(kDefault, "?", "unknown", "z,Command not found\r\n"),
        row(kDefault, "a N O Q, binary", "values as bytes", binary),
    };
    for (const char* const image : {"BTcom_floor_sensor.hex", "BTcom_floor_lis_sesnor_turret.hex"}) {
        rows.push_back(answers(image, "V", "version", "v,Version 1.1.4 December 2006\r\n"));
        rows.push_back(answers(image, "M", "floor sensors; on the bench there are none", "m,"));
        rows.push_back(row(image, "D E S", "motors", drives));
    }
    rows.push_back(answers("BTcom_20_LIS_rev84.hex", "V", "version", "v,Version 2.0.0 January 2008\r\n"));
    rows.push_back(row("BTcom_20_LIS_rev84.hex", "D E S", "motors", drives));
    return rows;
}

}  // namespace puckloop::images
