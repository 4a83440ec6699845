// Timer 2 with a clock of its own (ASSR): its registers take a new value two rising edges of TOSC1 after it
// was written, and say so. Source: data sheet 8272, "Asynchronous Operation of Timer/Counter2", "ASSR".

#include "emu/avr/peripherals/timing/timer.h"

#include "emu/avr/peripherals/shared_registers.h"

#include <algorithm>

namespace puckloop::avr {

namespace {
constexpr std::uint8_t kExclk = bit(6);  // ASSR; below them the update flags
constexpr std::uint64_t kEdgesToUpdate = 2;
enum UpdateOf : int { kControlB, kControlA, kCompareB, kCompareA, kCount };
}  // namespace

std::uint16_t Timer::update_address(int update) const {
    switch (update) {
    case kControlB:
        return static_cast<std::uint16_t>(setup_.control_a + 1);
    case kControlA:
        return setup_.control_a;
    case kCompareB:
        return setup_.compare_b;
    case kCompareA:
        return setup_.compare_a;
    default:
        return setup_.count;
    }
}

int Timer::update_of(std::uint16_t address) const {
    int update = 0;
    while (update < kCount && update_address(update) != address)
        ++update;
    return update;
}

void Timer::write_later(std::uint16_t address, std::uint8_t value) {
    const int update = update_of(address);
    state_.updates[static_cast<std::size_t>(update)] = {true, value,
                                                        watch_->edges(around_.now) + kEdgesToUpdate};
    reg(setup_.status) |= bit(update);
    plan_updates();
}

void Timer::plan_updates() {
    Cycle first = kNoCycle;
    for (const Update& update : state_.updates)
        if (update.waits) first = std::min(first, watch_->edge(update.edge));
    around_.events.schedule(update_slot_, first);
}

void Timer::update_due(void* owner, Cycle cycle) {
    auto& self = *static_cast<Timer*>(owner);
    self.take_updates(cycle);
    self.plan_updates();
}

void Timer::take_updates(Cycle now) {
    const std::uint64_t edges = watch_->edges(now);
    settle(now);
    for (int i = 0; i < kUpdates; ++i) {
        Update& update = state_.updates[static_cast<std::size_t>(i)];
        if (!update.waits || update.edge > edges) continue;
        update.waits = false;
        reg(setup_.status) &= static_cast<std::uint8_t>(~bit(i));
        constexpr std::uint8_t kAll = 0xFF;
        if (i == kControlA || i == kControlB)
            set_control(update_address(i), update.value, kAll);
        else
            write_wide(update_address(i), update.value);
    }
    plan();
}

// TCCR2x and OCR2x read as written, TCNT2 as it counts.
std::uint8_t Timer::read_control(void* owner, std::uint16_t address) {
    const auto& self = *static_cast<Timer*>(owner);
    const Update& update = self.state_.updates[static_cast<std::size_t>(self.update_of(address))];
    return update.waits ? update.value : self.reg(address);
}

// A rising edge at TOSC1 with EXCLK: the clock is counted, never foreseen.
void Timer::watch_edge() {
    settle(around_.now);
    const std::uint32_t division = divider();
    const std::uint64_t seen = watch_->edges(around_.now);
    watch_->pin_rose();
    if (division && prescaler_.ticks_of_edges(seen, division)) {
        state_.at = around_.now;
        pass(1);
    }
    take_updates(around_.now);
}

// EXCLK is chosen before AS2. What waits when the clock is switched is taken at once: the data sheet calls
// the registers' contents uncertain then.
void Timer::write_status(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Timer*>(owner);
    const std::uint8_t old = self.reg(address);
    const bool was_on = old & kAs2;
    self.around_.io.store(address, value, mask & (was_on ? kAs2 : kExclk | kAs2));
    const std::uint8_t now = self.reg(address);
    const bool on = now & kAs2;
    if (on == was_on) return;
    self.synchronise();
    for (Update& update : self.state_.updates)
        update.edge = 0;
    if (was_on) self.take_updates(self.around_.now);
    const bool pin = now & kExclk;
    self.watch_->use_pin(on && pin);
    self.prescaler_.use_watch(on, self.around_.now);
    const auto both = static_cast<std::uint8_t>(self.setup_.watch_in.mask() | self.setup_.watch_out.mask());
    self.ports_.take_over(self.setup_.watch_in.port, both, on && !pin);
    if (on && pin)
        self.ports_.override_direction(self.setup_.watch_in, false);
    else
        self.ports_.release_direction(self.setup_.watch_in);
    if (on && !pin && !self.watch_->fitted() && self.watch_->missing) self.watch_->missing();
    self.synchronise();
    self.plan_updates();
}

}  // namespace puckloop::avr
