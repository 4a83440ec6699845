#include "emu/tam_avr/tam_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::tam {

namespace {

using cosim::Time;

constexpr std::size_t kShownOfHash = 16;
/// Lines of the console that are all logged; then milestones.
constexpr std::uint64_t kAllLines = 100;
constexpr std::size_t kLongestLine = 120;
constexpr std::uint64_t kAllColours = 200;
constexpr const char* kUnit[] = {"console", "xbee"};
constexpr double kDutySteps = 256.0;

struct Lamp {
    const char* name;
    int red, green, blue;  // outputs of the LED driver
};
constexpr Lamp kLamps[] = {{"right", 1, 3, 2}, {"middle", 4, 6, 5}, {"left", 7, 9, 8}, {"top", 15, 14, 13}};

std::string frame_text(const cosim::UartFrame& frame) {
    const double baud = static_cast<double>(cosim::kSecond) / static_cast<double>(frame.bit_period);
    if (frame.is_break != 0) return fmt::format("a break at {:.0f} baud", baud);
    return fmt::format("0x{:02x} at {:.0f} baud", frame.data, baud);
}

}  // namespace

TamLog::TamLog(const std::string& path, const image::AvrImage& image, Time start)
    : lines_(path), start_(start) {
    if (!lines_.is_open()) return;
    std::size_t bytes = 0;
    for (const image::ByteSegment& segment : image.flash)
        bytes += segment.bytes.size();
    std::string text = fmt::format("firmware {}, {}, {} bytes of flash, {} symbols", image.file,
                                   image::name_of(image.format), bytes, image.symbols.size());
    if (!image.sha256.empty()) text += ", SHA-256 " + image.sha256.substr(0, kShownOfHash) + "...";
    lines_.line(0, text);
    if (start > 0) lines_.note(start, "switched on");
}

void TamLog::signal_changed(SignalId id, double value, Time now) {
    if (id >= kLed && id < kLed + kLeds) duty_[static_cast<std::size_t>(id - kLed)] = value;
    if (id == kProximityEmit) ++emitter_edges_;
    if (id == kPower && value == 0.0) {
        switched_off_ = now;
        lines_.note(now, "is off");
    }
    if (id == kPower && value != 0.0) lines_.note(now, "has supply again");
    if (id == kPowerClear && value > 0.0) lines_.note(now, "the firmware switches the board off");
    if (id == kXBeeReset)
        lines_.note(now, value > 0.0 ? "radio module held in reset" : "radio module released from reset");
    if (id == kNetworkLed && is_milestone(++network_led_changes_))
        lines_.note(now,
                    fmt::format("network LED {}, change {}", value > 0 ? "on" : "off", network_led_changes_));
}

void TamLog::input(SignalId id, double value, Time now) {
    if (id == kBattery) lines_.note(now, fmt::format("battery at {:.3f} V", value));
    if (id >= kBarrier + kBarriers) return;
    const auto index = static_cast<std::size_t>(id - kBarrier);
    const bool blocked = value > 0.5;
    if (blocked == blocked_[index]) return;
    blocked_[index] = blocked;
    if (blocked) ++interruptions_[index];
    lines_.note(
        now, fmt::format("{} barrier {}", index == 0 ? "front" : "back", blocked ? "interrupted" : "free"));
}

void TamLog::sent(int unit, const cosim::UartFrame& frame, Time now) {
    UartSeen& uart = uarts_[static_cast<std::size_t>(unit)];
    if (!uart.sent) {
        uart.sent = true;
        lines_.note(now, fmt::format("{}: first character sent, {}", kUnit[unit], frame_text(frame)));
    }
    if (unit == kConsoleUnit && frame.is_break == 0) text(static_cast<char>(frame.data), now);
}

void TamLog::arrived(int unit, const cosim::UartFrame& frame, Time now, bool listening) {
    UartSeen& uart = uarts_[static_cast<std::size_t>(unit)];
    if (uart.arrived) return;
    uart.arrived = true;
    lines_.note(now, fmt::format("{}: first character arrives, {}{}", kUnit[unit], frame_text(frame),
                                 listening ? "" : "; the receiver is off"));
}

void TamLog::text(char character, Time now) {
    if (!lines_.is_open()) return;
    const bool end = character == '\n' || character == '\r';
    if (!end && character >= ' ' && character <= '~') line_ += character;
    if (line_.empty() || (!end && line_.size() < kLongestLine)) return;
    const std::uint64_t count = ++line_count_;
    if (count <= kAllLines || is_milestone(count))
        lines_.note(now,
                    fmt::format("console: {}{}", line_,
                                count == kAllLines ? " (from here on only powers of two are logged)" : ""));
    line_.clear();
}

void TamLog::look(const avr::Chip& chip) {
    const Time now = lines_.begin_look();
    read_report(now, chip);
    read_colours(now);
    lines_.write_until(now);
}

void TamLog::read_report(Time now, const avr::Chip& chip) {
    const avr::ChipReport report = chip.report();
    const auto time_of = [&](avr::Cycle cycle) {
        return std::clamp(chip.clock().time_of(cycle) + start_, lines_.written(), now);
    };
    for (; resets_ < report.resets.size(); ++resets_) {
        const avr::ResetRecord& reset = report.resets[resets_];
        if (chip.clock().time_of(reset.cycle) + start_ > now) break;  // not yet switched on
        lines_.note(time_of(reset.cycle),
                    fmt::format("reset: {}, pc 0x{:05x}", avr::to_string(reset.cause), reset.pc));
    }
    for (; unmodelled_ < report.unmodelled.size(); ++unmodelled_) {
        const avr::UnmodelledTouch& touch = report.unmodelled[unmodelled_];
        lines_.note(now,
                    fmt::format("first {} of {}, at pc 0x{:05x}", touch.write ? "write" : "read",
                                touch.name.empty()
                                    ? fmt::format("0x{:03x}, where the chip has no register", touch.address)
                                    : touch.name + ", which is not modelled",
                                touch.pc));
    }
    for (; warnings_ < report.warnings.size(); ++warnings_)
        lines_.note(now, fmt::format("warning: {}, at pc 0x{:05x}", report.warnings[warnings_].text,
                                     report.warnings[warnings_].pc));
}

/// A colour is set LED by LED: it is logged when a look finds it changed, all lights in one line.
void TamLog::read_colours(Time now) {
    const auto changed = [&](int led) {
        const auto i = static_cast<std::size_t>(led);
        return duty_[i] != shown_[i];
    };
    std::string text;
    for (const Lamp& lamp : kLamps) {
        if (!changed(lamp.red) && !changed(lamp.green) && !changed(lamp.blue)) continue;
        text += fmt::format("{}{}", text.empty() ? "lights of 256: " : "; ", lamp.name);
        for (const int led : {lamp.red, lamp.green, lamp.blue}) {
            const auto i = static_cast<std::size_t>(led);
            shown_[i] = duty_[i];
            text += fmt::format(" {:.0f}", std::round(duty_[i] * kDutySteps));
        }
    }
    if (text.empty()) return;
    const std::uint64_t count = ++colour_changes_;
    if (count <= kAllColours || is_milestone(count)) lines_.note(now, text + " (red green blue)");
}

void TamLog::end(Time now, const Board& board) {
    if (!lines_.is_open()) return;
    settle();
    read_report(now, board.chip());
    read_colours(now);
    lines_.write_until(cosim::kNever);
    for (int unit = 0; unit < 2; ++unit) {
        const chip::UartCounters& counters = board.chip().uart_counters(unit);
        lines_.line(now, fmt::format("{}: {} sent, {} received, {} framing errors, {} overruns", kUnit[unit],
                                     counters.sent, counters.received, counters.framing_errors,
                                     counters.overruns));
    }
    const avr::ChipReport report = board.chip().report();
    lines_.line(now, fmt::format("end: {} cycles, {} instructions, at pc 0x{:05x}; {} resets; front barrier "
                                 "interrupted {} times, back {} times{}",
                                 report.cycles, report.instructions, board.chip().pc(), report.resets.size(),
                                 interruptions_[0], interruptions_[1], board.powered() ? "" : "; off"));
}

}  // namespace puckloop::tam
