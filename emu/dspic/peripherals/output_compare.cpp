#include "emu/dspic/peripherals/output_compare.h"

#include "emu/dspic/devices/register_bits.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kOCxCON{"OC?CON"};
enum Mode : int { kOff = 0, kHigh = 1, kLow = 2, kToggle = 3, kPulse = 4, kPulses = 5 };

constexpr std::uint16_t kUnitBytes = 6;

}  // namespace

OutputCompare::OutputCompare(const Surroundings& around, std::span<const Unit> units,
                             std::array<Timer*, 2> timers, Ports& ports, Pins& pins)
    : around_(around),
      units_(units),
      bases_{Base{this, timers[0]}, Base{this, timers[1]}},
      ports_(ports),
      pins_(pins),
      states_(units.size()),
      slot_(around.events.add(this, due)) {
    for (const Unit& unit : units_) {
        around_.sfr.hook(unit.rs, this, nullptr, write_rs);
        around_.sfr.mark_idempotent(unit.rs);
        around_.sfr.hook(static_cast<std::uint16_t>(unit.rs + 2), this, nullptr, write_r);
        around_.sfr.hook(static_cast<std::uint16_t>(unit.rs + 4), this, nullptr, write_con);
    }
    for (Base& base : bases_)
        base.timer->serve(&base, timer_changed, period_over);
}

void OutputCompare::reset() {
    around_.events.cancel(slot_);
    for (std::size_t i = 0; i < units_.size(); ++i) {
        const OutputCompareState reported = states_[i].reported;
        states_[i] = {};
        states_[i].reported = reported;
        tell(i, around_.now);
    }
}

std::size_t OutputCompare::index_of(std::uint16_t address) const {
    return (address - units_.front().rs) / std::size_t{kUnitBytes};
}

int OutputCompare::mode(std::size_t index) const {
    return static_cast<int>(kOCxCON["OCM"].of(con(index)));
}

Timer& OutputCompare::timer(std::size_t index) const {
    return *bases_[con(index) & kOCxCON["OCTSEL"] ? 1 : 0].timer;
}

OutputCompareState OutputCompare::present(int unit) const {
    const auto index = static_cast<std::size_t>(unit - 1);
    OutputCompareState state;
    if (unit < 1 || index >= units_.size()) return state;
    state.mode = mode(index);
    const Timer& base = timer(index);
    state.running = state.mode != kOff && base.counts();
    state.level = states_[index].level;
    const Cycle period = base.period_cycles();
    const Cycle tick = base.count_cycles();
    if (pwm(index)) {
        state.period = period;
        state.high = std::min<Cycle>(r(index) * tick, period);
    } else if (state.mode == kToggle) {
        state.period = 2 * period;
        state.high = period;
    } else if (state.mode == kPulses) {
        state.period = period;
        state.high = (rs(index) - r(index)) * tick + (rs(index) > r(index) ? 0 : period);
    }
    return state;
}

// Tells the board if what it knows has changed. A level that moves by itself, edge by edge, is at the pin.
void OutputCompare::tell(std::size_t index, Cycle at) {
    OutputCompareState now = present(static_cast<int>(index) + 1);
    if (now.period) now.level = false;
    if (now == states_[index].reported) return;
    states_[index].reported = now;
    pins_.output_compare_changed(static_cast<int>(index) + 1, at);
}

void OutputCompare::drive(std::size_t index) {
    const std::uint16_t pin = bit(units_[index].pin);
    if (mode(index) == kOff)
        ports_.give_back(units_[index].port, pin);
    else
        ports_.lend(units_[index].port, pin, pin, states_[index].level && !pwm(index) ? pin : 0);
}

void OutputCompare::begin(std::size_t index) {
    State& state = states_[index];
    state.step = mode(index) == kOff || pwm(index) ? Step::Idle : Step::First;
    if (mode(index) != kToggle) state.level = mode(index) == kLow;
    drive(index);
    if (pwm(index)) timer(index).want_period();
    plan(index, around_.now + 1);
}

void OutputCompare::plan(std::size_t index, Cycle from) {
    State& state = states_[index];
    state.due = kNoCycle;
    if (state.step != Step::Idle)
        state.due = timer(index).next_at(state.step == Step::First ? r(index) : rs(index), from);
    plan_all();
}

void OutputCompare::plan_all() {
    Cycle first = kNoCycle;
    for (const State& state : states_)
        first = std::min(first, state.due);
    around_.events.schedule(slot_, first);
}

void OutputCompare::edge(std::size_t index, Cycle at) {
    State& state = states_[index];
    const bool first = state.step == Step::First;
    bool interrupt = true;
    switch (mode(index)) {
    case kHigh:
        state.level = true;
        state.step = Step::Idle;
        break;
    case kLow:
        state.level = false;
        state.step = Step::Idle;
        break;
    case kToggle:
        state.level = !state.level;
        break;
    default:  // pulses
        state.level = first;
        interrupt = !first;
        state.step = first ? Step::Second : mode(index) == kPulse ? Step::Idle : Step::First;
        break;
    }
    drive(index);
    if (interrupt) around_.interrupts.raise(units_[index].irq, at);
    plan(index, at);
    tell(index, at);
}

void OutputCompare::due(void* owner, Cycle due) {
    OutputCompare& self = *static_cast<OutputCompare*>(owner);
    for (std::size_t i = 0; i < self.states_.size(); ++i)
        if (self.states_[i].due <= due) self.edge(i, due);
}

void OutputCompare::timer_changed(void* owner, Cycle at) {
    const Base& base = *static_cast<Base*>(owner);
    OutputCompare& self = *base.self;
    for (std::size_t i = 0; i < self.units_.size(); ++i) {
        if (self.mode(i) == kOff || &self.timer(i) != base.timer) continue;
        if (self.states_[i].step != Step::Idle) self.plan(i, at);
        self.tell(i, at);
    }
}

// A new period of PWM takes its duty from OCxRS.
void OutputCompare::period_over(void* owner, Cycle at) {
    const Base& base = *static_cast<Base*>(owner);
    OutputCompare& self = *base.self;
    for (std::size_t i = 0; i < self.units_.size(); ++i) {
        if (!self.pwm(i) || &self.timer(i) != base.timer || self.r(i) == self.rs(i)) continue;
        self.r(i) = self.rs(i);
        self.tell(i, at);
    }
}

void OutputCompare::write_rs(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    OutputCompare& self = *static_cast<OutputCompare*>(owner);
    std::uint16_t& stored = self.around_.sfr.raw(address);
    const std::uint16_t next = merge(stored, value, mask);
    if (next == stored) return;
    stored = next;
    const std::size_t index = self.index_of(address);
    if (self.pwm(index)) {
        self.timer(index).want_period();
    } else if (self.states_[index].step != Step::Idle) {
        self.plan(index, self.around_.now + 1);
        self.tell(index, self.around_.now + 1);
    }
}

void OutputCompare::write_r(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    OutputCompare& self = *static_cast<OutputCompare*>(owner);
    const std::size_t index = self.index_of(address);
    if (self.pwm(index)) return;  // read only then
    self.around_.sfr.store(address, value, mask);
    if (self.states_[index].step == Step::Idle) return;
    self.plan(index, self.around_.now + 1);
    self.tell(index, self.around_.now + 1);
}

void OutputCompare::write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    OutputCompare& self = *static_cast<OutputCompare*>(owner);
    const std::size_t index = self.index_of(address);
    const std::uint16_t old = self.con(index);
    self.around_.sfr.store(address, value, static_cast<std::uint16_t>(mask & ~kOCxCON["OCFLT"]));
    if (self.con(index) == old) return;
    self.begin(index);
    self.tell(index, self.around_.now + 1);
}

}  // namespace puckloop::dspic
