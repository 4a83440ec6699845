#include "emu/rab_board/rab_log.h"

#include <fmt/format.h>

#include <bit>

namespace puckloop::rab {

namespace {

using cosim::Time;

/// Frames that are all logged; then milestones.
constexpr std::uint64_t kAllFrames = 20;
/// Text on UART2: the boot messages, and not what raw-peak mode prints for ever.
constexpr int kAllLines = 10;
constexpr std::size_t kLongestLine = 120;

std::string emitters_text(std::uint16_t emitters) {
    if (std::popcount(emitters) == kSensorCount) return "all emitters";
    std::string text = "emitters";
    for (int i = 0; i < kSensorCount; ++i)
        if (((emitters >> i) & 1u) != 0) text += fmt::format(" {}", i + 1);
    return text;
}

}  // namespace

RabLog::RabLog(const std::string& path, const image::Image& image)
    : chip_(path, image), i2c_([this](Time time, std::string text) { chip_.note(time, std::move(text)); }) {
    frames_.on_frame = [this](const EmittedFrame& emitted) { frame(emitted); };
    frames_.on_irregular = [this](Time start, Time seen, std::size_t chips) {
        if (is_milestone(frames_.irregular()))
            chip_.note(
                seen, fmt::format("emitters on for about {} chips from {:.6f} s that are no frame, {} so far",
                                  chips, cosim::to_seconds(start), frames_.irregular()));
    };
}

void RabLog::frame(const EmittedFrame& emitted) {
    const std::uint64_t count = frames_.frames();
    if (count > kAllFrames && !is_milestone(count)) return;
    std::string text = fmt::format("frame {} from {:.6f} s:", count, cosim::to_seconds(emitted.start));
    const char* separator = " ";
    for (const auto& [payload, emitters] : emitted.payloads) {
        text += fmt::format("{}{:0{}x} on {}", separator, payload, emitted.size / 4, emitters_text(emitters));
        separator = ", ";
    }
    if (count == kAllFrames) text += " (from here on only powers of two are logged)";
    chip_.note(emitted.seen, std::move(text));
}

void RabLog::signal_changed(SignalId id, double value, Time now) {
    if (id == kPower && is_milestone(++codes_))
        chip_.note(now, fmt::format("potentiometer at {}{}", value,
                                    codes_ > 1 ? fmt::format(", change {}", codes_) : ""));
    if (id != kCarrier || carrier_ == (value > 0)) return;
    carrier_ = value > 0;
    chip_.note(now, carrier_ ? fmt::format("carrier on, {:.1f} kHz", value * 1e-3) : "carrier off");
}

void RabLog::sent(int unit, const cosim::UartFrame& frame, Time now) {
    chip_.sent(unit, frame, now);
    if (unit == 2 && frame.is_break == 0) text(static_cast<char>(frame.data), now);
}

void RabLog::text(char character, Time now) {
    if (lines_ >= kAllLines) return;
    const bool end = character == '\n' || character == '\r';
    if (!end && character >= ' ' && character <= '~') line_ += character;
    if (line_.empty() || (!end && line_.size() < kLongestLine)) return;
    ++lines_;
    chip_.note(now,
               fmt::format("uart2 prints: {}{}", line_, lines_ == kAllLines ? " (no more is logged)" : ""));
    line_.clear();
}

void RabLog::look(const dspic::Chip& chip) {
    frames_.settle(next_look());
    chip_.look(chip);
}

void RabLog::end(Time now, const dspic::Chip& chip) {
    frames_.settle(now);
    const I2cCounters& i2c = i2c_.counters();
    chip_.end(now, chip,
              fmt::format("{} frames emitted, {} irregular; i2c: {} transfers, SCL held for {:.3f} ms in all",
                          frames_.frames(), frames_.irregular(), i2c.transfers,
                          cosim::to_seconds(i2c.stretched) * 1e3));
}

}  // namespace puckloop::rab
