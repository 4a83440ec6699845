#include "emu/pic/pic_log.h"

#include <fmt/format.h>

namespace puckloop::pic {

using cosim::Time;

namespace {

/// Changes of one LED that are all logged; of a program that dims by switching only milestones follow.
constexpr std::uint64_t kAllChanges = 500;

bool is_led(SignalId id) {
    return (id >= kLed && id < kLed + kLedCount) || id == kLedFront || id == kLedBody;
}

}  // namespace

void PicLog::signal_changed(SignalId id, double value, Time now) {
    if (!chip_.is_open()) return;
    if (id == kWheelLeft || id == kWheelRight) {
        MotorLog& motor = motors_[id == kWheelLeft ? 0 : 1];
        if (auto line = motor.still(now)) chip_.note(line->first, std::move(line->second));
        if (auto line = motor.step(static_cast<std::int64_t>(value), now))
            chip_.note(line->first, std::move(line->second));
        return;
    }
    if (!is_led(id)) return;
    const std::uint64_t count = ++changes_[id];
    if (count > kAllChanges && !is_milestone(count)) return;
    std::string text = fmt::format("{} {}", signals()[id].name, value > 0 ? "on" : "off");
    if (count >= kAllChanges)
        text += fmt::format(" ({} changes so far, from here on only powers of two are logged)", count);
    chip_.note(now, std::move(text));
}

void PicLog::look(const dspic::Chip& chip) {
    for (MotorLog& motor : motors_)
        if (auto line = motor.still(next_look())) chip_.note(line->first, std::move(line->second));
    chip_.look(chip);
}

void PicLog::end(Time now, const dspic::Chip& chip, const Board& board) {
    chip_.end(
        now, chip,
        fmt::format("wheels at {} and {} steps", board.left_motor().steps(), board.right_motor().steps()));
}

}  // namespace puckloop::pic
