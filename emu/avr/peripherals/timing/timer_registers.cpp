// The timers' registers: 8 bits wide on the bus, 16 bits through TEMP.

#include "emu/avr/peripherals/timing/timer.h"

namespace puckloop::avr {

Timer::Timer(const Surroundings& around, const Setup& setup, Prescaler& prescaler, Ports& ports,
             WatchClock* watch)
    : around_(around),
      setup_(setup),
      prescaler_(prescaler),
      ports_(ports),
      watch_(watch),
      flags_(around, setup.interrupts, this, &touched),
      slot_(around.events.add(this, &due)),
      noise_slot_(around.events.add(this, &noise_over)),
      update_slot_(around.events.add(this, &update_due)) {
    IoSpace& io = around_.io;
    const auto read = setup.status ? &read_control : nullptr;
    io.hook(setup.control_a, this, read, &write_control);
    io.hook(static_cast<std::uint16_t>(setup.control_a + 1), this, read, &write_control);
    if (setup.status) io.hook(setup.status, this, nullptr, &write_status);
    if (setup.control_c) io.hook(setup.control_c, this, nullptr, &write_force);
    for (const std::uint16_t low : {setup.count, setup.compare_a, setup.compare_b, setup.capture}) {
        if (!low) continue;
        io.hook(low, this, &read_value, &write_value);
        io.hook_quiet(low, &look_at_value);
        if (!setup.wide) continue;
        io.hook(static_cast<std::uint16_t>(low + 1), this, &read_value, &write_value);
        io.hook_quiet(static_cast<std::uint16_t>(low + 1), &look_at_value);
    }
    if (!setup.wide) io.set_follow(setup.count, &follow_count);
    flags_.follow(&flags_change);
    ports_.listen(this, &pins_changed);
}

void Timer::reset() {
    state_ = {};
    state_.at = around_.now;
    around_.events.cancel(slot_);
    around_.events.cancel(noise_slot_);
    around_.events.cancel(update_slot_);
    if (!watch_) return;
    watch_->use_pin(false);
    prescaler_.use_watch(false, around_.now);
}

void Timer::write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Timer*>(owner);
    if (self.asynchronous())
        self.write_later(address, merged(read_control(owner, address), value, mask));
    else
        self.set_control(address, value, mask);
}

void Timer::set_control(std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    settle(around_.now);
    constexpr std::uint8_t kForceBits = 0xC0;  // FOCnA, FOCnB of the 8-bit timers' TCCRnB
    const bool force = !setup_.wide && address != setup_.control_a;
    // Another clock is selected: the next clock still belongs to the old one (docs/measured_silicon.md).
    if (address != setup_.control_a && !asynchronous() &&
        division_of(merged(control_b(), value, mask)) != divider())
        settle(around_.now + 1);
    around_.io.store(address, value, force ? mask & static_cast<std::uint8_t>(~kForceBits) : mask);
    if (!waveform().buffered()) state_.compare = state_.buffered;
    if (!waveform().dual_slope()) state_.counter.down = false;
    if (force) write_force(this, 0, value, mask);
    connect_outputs();
    plan();
}

// FOCnx: an immediate compare match at the pin, without a flag; reads as 0.
void Timer::write_force(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Timer*>(owner);
    if (self.waveform().buffered()) return;
    self.settle(self.around_.now);
    for (int channel = 0; channel < 2; ++channel)
        if (value & mask & bit(7 - channel)) self.match(channel);
}

void Timer::set_compare(int channel, std::uint16_t value) {
    state_.buffered[static_cast<std::size_t>(channel)] = value;
    if (!waveform().buffered()) state_.compare = state_.buffered;
}

std::uint16_t Timer::read_wide(std::uint16_t low_address) {
    if (low_address == setup_.count) return static_cast<std::uint16_t>(state_.counter.count);
    if (low_address == setup_.capture) return state_.capture;
    return state_.buffered[low_address == setup_.compare_b];
}

void Timer::write_wide(std::uint16_t low_address, std::uint16_t value) {
    if (low_address == setup_.count) {
        state_.counter = {value, false};
        state_.blocked = true;
        // The write has priority over the count of its clock (docs/measured_silicon.md).
        if (!asynchronous()) state_.at = around_.now + 1;
    } else if (low_address == setup_.capture) {  // only where it is the top
        if (waveform().top == Waveform::Top::Capture) state_.capture = value;
    } else {
        set_compare(low_address == setup_.compare_b, value);
    }
}

// The low byte moves all 16 bits: reading it leaves the high byte in TEMP, writing it takes the high byte
// from there. OCRnx is read without TEMP.
std::uint8_t Timer::read_value(void* owner, std::uint16_t address) {
    auto& self = *static_cast<Timer*>(owner);
    self.synchronise();
    if (self.asynchronous() && address != self.setup_.count)
        if (const Update& u = self.state_.updates[static_cast<std::size_t>(self.update_of(address))]; u.waits)
            return u.value;
    if (!self.setup_.wide) return static_cast<std::uint8_t>(self.read_wide(address));
    const auto low = static_cast<std::uint16_t>(address & ~1u);
    const std::uint16_t value = self.read_wide(low);
    const bool compare = low == self.setup_.compare_a || low == self.setup_.compare_b;
    if (address != low) return compare ? static_cast<std::uint8_t>(value >> 8) : self.state_.temp;
    if (!compare) self.state_.temp = static_cast<std::uint8_t>(value >> 8);
    return static_cast<std::uint8_t>(value);
}

/// Both bytes as they are now: TEMP stays.
std::uint8_t Timer::look_at_value(void* owner, std::uint16_t address) {
    auto& self = *static_cast<Timer*>(owner);
    self.synchronise();
    if (!self.setup_.wide) return static_cast<std::uint8_t>(self.read_wide(address));
    const std::uint16_t value = self.read_wide(static_cast<std::uint16_t>(address & ~1u));
    return static_cast<std::uint8_t>(address % 2 == 0 ? value : value >> 8);
}

/// Up to the end of the counter's way; 16-bit counters have TEMP as a side effect.
std::size_t Timer::follow_count(void* owner, std::uint16_t, Cycle first, Cycle period,
                                std::span<std::uint8_t> values) {
    const auto& self = *static_cast<Timer*>(owner);
    if (self.waveform().dual_slope() || first < self.state_.at || self.asynchronous()) return 0;
    const std::uint32_t count = self.state_.counter.count, end = self.top();
    const std::uint64_t room = (count > end ? self.max() : end) - count;
    const Cycle division = self.divider();
    const bool stands = division == 0 || (division > 1 && self.prescaler_.held());
    Cycle ticks = stands ? 0 : self.prescaler_.ticks(self.state_.at, first, division);
    Cycle position = stands ? 0 : self.prescaler_.position(first, division);
    const Cycle whole = stands ? 0 : period / division, rest = stands ? 0 : period % division;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (ticks > room) return i;
        values[i] = static_cast<std::uint8_t>(count + ticks);
        ticks += whole;
        position += rest;
        if (position >= division && !stands) {
            position -= division;
            ++ticks;
        }
    }
    return values.size();
}

Cycle Timer::flags_change(void* owner) {
    const auto& self = *static_cast<Timer*>(owner);
    constexpr std::uint8_t kEvery = 0xFF;
    const std::uint32_t division = self.divider();
    const std::uint64_t tick = division ? self.next_tick(kEvery) : kNoTick;
    return tick == kNoTick ? kNoCycle : self.prescaler_.tick(self.state_.at, tick, division);
}

void Timer::write_value(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t) {
    auto& self = *static_cast<Timer*>(owner);
    if (self.asynchronous()) return self.write_later(address, value);
    self.settle(self.around_.now);
    if (!self.setup_.wide)
        self.write_wide(address, value);
    else if (address & 1)
        self.state_.temp = value;
    else
        self.write_wide(address, static_cast<std::uint16_t>(self.state_.temp << 8 | value));
    self.plan();
}

}  // namespace puckloop::avr
