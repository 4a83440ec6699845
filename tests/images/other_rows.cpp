// Images that are one program: ARGoS' firmware, boot loaders, the Bluetooth mirror, range-and-bearing boards.

#include "tests/images/trial.h"

#include <fmt/format.h>

namespace puckloop::images {

namespace {

Row row(const char* image, std::string at, std::string says, Trial::Setup setup,
        std::function<std::string(Trial&)> see) {
    return {image, std::move(at), std::move(says), setup, std::move(see)};
}

/// A session: start byte and four bytes, then a command; a record of `size` bytes each.
std::string serves(Trial& trial, std::size_t size) {
    const std::string greeting = trial.ask(std::string("\x01\0\0\0\0", 5), 2, 0.4);
    expect(greeting.size() == size, fmt::format("{} bytes after the start", greeting.size()));
    const std::string answer = trial.ask(std::string("\0\0\0\0\0\0\0\0\0\0N\0", 12), 2, 0.2);
    expect(answer.size() == size, fmt::format("{} bytes after a command", answer.size()));
    return fmt::format("{} bytes after the start byte and after each command", size);
}

std::string asks_module(Trial& trial) {
    trial.run(1.0);
    const std::string asked = trial.heard(1);
    expect(asked.find("\x02\x52") != std::string::npos, fmt::format("{} bytes at UART1", asked.size()));
    return "asks the Bluetooth module at UART1 (on the bench there is none)";
}

std::string mirrors(Trial& trial) {
    trial.run(0.5);
    const std::string greeting = trial.heard(2);
    expect(!greeting.empty(), "silent at UART2");
    return "its menu at UART2";
}

/// What a loader answers to the byte that a computer begins with.
std::string loads(Trial& trial, int unit) {
    const std::string answer = trial.ask("\xC1", unit, 0.05);
    expect(answer.size() >= 2 && answer.find('K') != std::string::npos,
           fmt::format("{} bytes", answer.size()));
    return "0xC1 is answered with its device's number and K";
}

std::string idles(Trial& trial) {
    trial.run(1.0);
    return "runs";
}

}  // namespace

std::vector<Row> other_rows() {
    const Trial::Setup argos{.boot = 42.0};
    const Trial::Setup rab{.board = "rab", .boot = 1.0};
    std::vector<Row> rows{
        row("epuck_firmware.hex", "a session at UART2", "start, then 72 bytes for each command of 12", argos,
            [](Trial& trial) { return serves(trial, 72); }),
        row("epuck_firmware_old.hex", "a session at UART2", "an older build: 60 bytes", argos,
            [](Trial& trial) { return serves(trial, 60); }),
        row("bluetoot_mirror.hex", "selector 0", "a menu at UART2 for the Bluetooth module", {}, mirrors),
        row("bluetoot_mirror.hex", "selector 1", "connects to another e-puck", {.selector = 1}, asks_module),
    };
    const Trial::Setup reset{.boot = 0.02};
    for (const char* const image : {"tinybld_ds6014A_7.37Mhz_115200uart1_8xPLL_with_LEDs.hex",
                                    "tinybld_ds6014A_7.37Mhz_115200uart1_8xPLL_with_LEDs_helper.hex"})
        rows.push_back(row(image, "after reset", "boot loader at UART1", reset,
                           [](Trial& trial) { return loads(trial, 1); }));
    rows.push_back(row("tinybld_ds6014A_7.37Mhz_115200uart2_8xPLL_with_LEDs.hex", "after reset",
                       "boot loader at UART2", reset, [](Trial& trial) { return loads(trial, 2); }));
    for (const char* const image : {"randb.hex", "erab_1to4b.hex"})
        rows.push_back(row(image, "range-and-bearing board", "receives and sends (rab.md)", rab, idles));
    return rows;
}

}  // namespace puckloop::images
