#include "emu/board/chip_log.h"

#include "emu/board/chip_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace puckloop::board {

using cosim::Time;

namespace {

constexpr std::size_t kShownOfHash = 16;

std::string image_line(const image::Image& image) {
    std::string text = fmt::format("firmware {}, {}, {} program words", image.file,
                                   image::name_of(image.format), image.program.size());
    if (!image.eeprom.empty()) text += fmt::format(", {} of EEPROM", image.eeprom.size());
    if (!image.config.empty()) text += fmt::format(", {} of configuration", image.config.size());
    text += fmt::format(", {} symbols", image.symbols.size());
    if (!image.sha256.empty()) text += ", SHA-256 " + image.sha256.substr(0, kShownOfHash) + "...";
    return text;
}

std::string frame_text(const cosim::UartFrame& frame) {
    const double baud = static_cast<double>(cosim::kSecond) / static_cast<double>(frame.bit_period);
    if (frame.is_break != 0) return fmt::format("a break at {:.0f} baud", baud);
    return fmt::format("0x{:02x} at {:.0f} baud", frame.data, baud);
}

}  // namespace

ChipLog::ChipLog(const std::string& path, const image::Image& image) : lines_(path), symbols_(image) {
    if (is_open()) lines_.line(0, image_line(image));
}

std::string ChipLog::place(std::uint32_t pc) const {
    const std::string symbol = symbols_.place(pc);
    return fmt::format("pc 0x{:04x}{}", pc, symbol.empty() ? "" : " (" + symbol + ")");
}

void ChipLog::sent(int unit, const cosim::UartFrame& frame, Time now) {
    UartSeen& uart = uarts_[static_cast<std::size_t>(unit - 1)];
    if (!is_open() || uart.sent) return;
    uart.sent = true;
    note(now, fmt::format("uart{}: first character sent, {}", unit, frame_text(frame)));
}

void ChipLog::arrived(int unit, const cosim::UartFrame& frame, Time now, bool listening) {
    UartSeen& uart = uarts_[static_cast<std::size_t>(unit - 1)];
    if (!is_open() || uart.arrived) return;
    uart.arrived = true;
    note(now, fmt::format("uart{}: first character arrives, {}{}", unit, frame_text(frame),
                          listening ? "" : "; the receiver is off"));
}

void ChipLog::look(const dspic::Chip& chip) {
    const Time now = lines_.begin_look();
    read_report(now, chip);
    read_errors(now, chip);
    lines_.write_until(now);
}

void ChipLog::read_report(Time now, const dspic::Chip& chip) {
    const dspic::ChipReport report = chip.report();
    // Cycles before a change of clock cannot be turned into times any more: they are of this stretch.
    const auto time_of = [&](dspic::Cycle cycle) {
        return std::clamp(chip.clock().time_of(cycle), lines_.written(), now);
    };
    for (; resets_ < report.resets.size(); ++resets_) {
        const dspic::ResetRecord& reset = report.resets[resets_];
        note(time_of(reset.cycle), resets_ == 0 ? "power-on, reset " + reset.cause
                                                : "reset " + reset.cause + " at " + place(reset.pc));
    }
    for (; traps_ < report.traps.size(); ++traps_) {
        const dspic::TrapRecord& trap = report.traps[traps_];
        note(time_of(trap.cycle), "trap " + trap.name + " at " + place(trap.pc));
    }
    for (; unmodelled_ < report.unmodelled.size(); ++unmodelled_) {
        const dspic::UnmodelledTouch& touch = report.unmodelled[unmodelled_];
        note(time_of(touch.cycle),
             fmt::format("first {} of {}, at {}", touch.write ? "write" : "read",
                         touch.name.empty()
                             ? fmt::format("0x{:04x}, where the chip has no register", touch.address)
                             : touch.name + ", which is not modelled",
                         place(touch.pc)));
    }
    for (; warnings_ < report.warnings.size(); ++warnings_) {
        const dspic::ChipWarning& warning = report.warnings[warnings_];
        note(time_of(warning.cycle), "warning: " + warning.text + ", at " + place(warning.pc));
    }
}

void ChipLog::read_errors(Time now, const dspic::Chip& chip) {
    for (std::size_t i = 0; i < kUarts; ++i) {
        const dspic::UartCounters counters = chip.uart_counters(static_cast<int>(i) + 1);
        dspic::UartCounters& logged = uarts_[i].counters;
        const auto log_growth = [&](std::uint64_t& before, std::uint64_t count, const char* what) {
            if (count < std::max<std::uint64_t>(1, 2 * before)) return;
            before = std::bit_floor(count);
            note(now, fmt::format("uart{}: {} so far: {}", i + 1, what, count));
        };
        log_growth(logged.framing_errors, counters.framing_errors, "framing errors");
        log_growth(logged.parity_errors, counters.parity_errors, "parity errors");
        log_growth(logged.overruns, counters.overruns, "characters lost by overrun");
    }
}

void ChipLog::end(Time now, const dspic::Chip& chip, const std::string& board) {
    if (!is_open()) return;
    settle();
    read_report(now, chip);
    read_errors(now, chip);
    lines_.write_until(cosim::kNever);
    for (int unit = 1; unit <= static_cast<int>(kUarts); ++unit) {
        const dspic::UartCounters counters = chip.uart_counters(unit);
        lines_.line(
            now, fmt::format("uart{}: {} sent, {} received, {} framing errors, {} parity errors, {} overruns",
                             unit, counters.sent, counters.received, counters.framing_errors,
                             counters.parity_errors, counters.overruns));
    }
    if (const std::optional<dspic::WaitReport> wait = chip.waiting(); wait && wait->hung)
        lines_.line(now, "warning: the program " + *waiting_text(chip, wait));
    const dspic::ChipReport report = chip.report();
    lines_.line(now, fmt::format("end: {} cycles, {} instructions, at {}; {} resets, {} traps, {} unmodelled "
                                 "registers; {}",
                                 report.cycles, report.instructions, place(chip.pc()), report.resets.size(),
                                 report.traps.size(), report.unmodelled.size(), board));
}

}  // namespace puckloop::board
