#include "emu/board/chip_log.h"

#include "emu/board/chip_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace puckloop::board {

using cosim::Time;

namespace {

constexpr Time kLook = 10 * cosim::kMillisecond;
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

ChipLog::ChipLog(const std::string& path, const image::Image& image)
    : log_(path), symbols_(image), next_look_(kLook) {
    if (is_open()) log_.line(0, image_line(image));
}

std::string ChipLog::place(std::uint32_t pc) const {
    const std::string symbol = symbols_.place(pc);
    return fmt::format("pc 0x{:04x}{}", pc, symbol.empty() ? "" : " (" + symbol + ")");
}

void ChipLog::note(Time time, std::string text) {
    if (is_open()) lines_.emplace_back(time, std::move(text));
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
    const Time now = next_look_;
    next_look_ += kLook;
    read_report(now, chip);
    read_errors(now, chip);
    write_until(now);
}

void ChipLog::read_report(Time now, const dspic::Chip& chip) {
    const dspic::ChipReport report = chip.report();
    // Cycles before a change of clock cannot be turned into times any more: they are of this stretch.
    const auto time_of = [&](dspic::Cycle cycle) {
        return std::clamp(chip.clock().time_of(cycle), written_, now);
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
        dspic::UartCounters& told = uarts_[i].counters;
        const auto tell = [&](std::uint64_t& before, std::uint64_t count, const char* what) {
            if (count < std::max<std::uint64_t>(1, 2 * before)) return;
            before = std::bit_floor(count);
            note(now, fmt::format("uart{}: {} so far: {}", i + 1, what, count));
        };
        tell(told.framing_errors, counters.framing_errors, "framing errors");
        tell(told.parity_errors, counters.parity_errors, "parity errors");
        tell(told.overruns, counters.overruns, "characters lost by overrun");
    }
}

void ChipLog::mark() {
    log_.mark();
    kept_.reset();
    marked_ = true;
    lines_at_mark_ = lines_.size();
}

void ChipLog::rewind() {
    log_.rewind();
    if (kept_) {
        lines_ = std::move(*kept_);
        kept_.reset();
    } else {
        lines_.resize(lines_at_mark_);
    }
}

void ChipLog::settle() {
    marked_ = false;
    kept_.reset();
    log_.settle();
}

void ChipLog::loaded(Time now) {
    if (!is_open()) return;
    for (const auto& [time, text] : history_)
        log_.line(cosim::to_seconds(time), text);
    // The saved board may have had no log, which never looks.
    next_look_ = std::max(next_look_, (now / kLook + 1) * kLook);
    written_ = std::min(written_, now);
}

void ChipLog::write_until(Time now) {
    if (marked_ && !kept_)
        kept_.emplace(lines_.begin(), lines_.begin() + static_cast<std::ptrdiff_t>(lines_at_mark_));
    std::sort(lines_.begin(), lines_.end());
    auto next = lines_.begin();
    for (; next != lines_.end() && next->first <= now; ++next) {
        log_.line(cosim::to_seconds(next->first), next->second);
        history_.push_back(std::move(*next));
    }
    lines_.erase(lines_.begin(), next);
    written_ = now;
}

void ChipLog::end(Time now, const dspic::Chip& chip, const std::string& board) {
    if (!is_open()) return;
    settle();
    read_report(now, chip);
    read_errors(now, chip);
    write_until(cosim::kNever);
    const double seconds = cosim::to_seconds(now);
    for (int unit = 1; unit <= static_cast<int>(kUarts); ++unit) {
        const dspic::UartCounters counters = chip.uart_counters(unit);
        log_.line(
            seconds,
            fmt::format("uart{}: {} sent, {} received, {} framing errors, {} parity errors, {} overruns",
                        unit, counters.sent, counters.received, counters.framing_errors,
                        counters.parity_errors, counters.overruns));
    }
    if (const std::optional<dspic::WaitReport> wait = chip.waiting(); wait && wait->hung)
        log_.line(seconds, "warning: the program " + *waiting_text(chip, wait));
    const dspic::ChipReport report = chip.report();
    log_.line(seconds,
              fmt::format("end: {} cycles, {} instructions, at {}; {} resets, {} traps, {} unmodelled "
                          "registers; {}",
                          report.cycles, report.instructions, place(chip.pc()), report.resets.size(),
                          report.traps.size(), report.unmodelled.size(), board));
}

}  // namespace puckloop::board
