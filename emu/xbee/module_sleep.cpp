// Sleep of a module by its own clock or its pin 9 (SLEEP_RQ). Source: XBee/XBee-PRO DigiMesh 2.4 manual
// (90000991), "Sleep modes": SM = 1 (asynchronous pin sleep), 4 (asynchronous cyclic sleep), 5 (cyclic, and
// kept awake by the pin), SP, ST. A module that sleeps neither hears nor relays, nor reads its serial line.

#include "emu/xbee/module.h"

#include <algorithm>

namespace puckloop::xbee {

using cosim::kMillisecond;
using cosim::Time;

namespace {

constexpr std::uint32_t kPinSleep = 1, kCyclic = 4, kCyclicWithPin = 5;  // SM
constexpr Time kBusyAgain = 10 * kMillisecond;

}  // namespace

void Module::sleep_request(bool level, Time now) {
    if (level == sleep_request_) return;
    sleep_request_ = level;
    add(now + options_.processing, {TaskKind::SleepPin});
}

bool Module::sleeps_cyclically() const {
    return settings_[kSM] == kCyclic || (settings_[kSM] == kCyclicWithPin && sleep_request_);
}

bool Module::wants_sleep() const {
    return sleeps_cyclically() || (settings_[kSM] == kPinSleep && sleep_request_);
}

/// After the pin or SM has changed.
void Module::consider_sleep(Time now) {
    if (!up_) return;
    if (settings_[kSM] == kPinSleep) {
        if (sleep_request_ && !asleep_) fall_asleep(now);
        if (!sleep_request_ && asleep_) wake_up(now);
    } else if (!sleeps_cyclically() && asleep_) {
        wake_up(now);
    } else if (sleeps_cyclically() && !asleep_) {
        stay_awake(now);
    }
}

/// Something came in by line or air: ST begins anew.
void Module::stay_awake(Time now) {
    if (!sleeps_cyclically()) return;
    const Time awake = static_cast<Time>(settings_[kST]) * kMillisecond;
    add(now + std::max(awake, options_.processing), {TaskKind::Sleep, ++sleep_turn_});
}

void Module::fall_asleep(Time now) {
    if (!waiting_.empty() || !packets_.empty() || !plain_.empty() || !out_.empty()) {
        // What it is at is finished first.
        add(now + kBusyAgain, {TaskKind::Sleep, ++sleep_turn_});
        return;
    }
    asleep_ = true;
    ++counts_.sleeps;
    tell_radio(false, now);
    if (settings_[kD7] == 1 && !cts_) air_.cts_changed(cts_ = true, now);
    constexpr Time kUnit = 10 * kMillisecond;
    if (sleeps_cyclically())
        add(now + static_cast<Time>(settings_[kSP]) * kUnit, {TaskKind::Wake, ++sleep_turn_});
}

void Module::wake_up(Time now) {
    asleep_ = false;
    new_reader(reader_mode_);
    tell_radio(true, now);
    update_cts(now);
    stay_awake(now);
}

}  // namespace puckloop::xbee
