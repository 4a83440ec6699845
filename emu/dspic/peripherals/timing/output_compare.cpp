#include "emu/dspic/peripherals/timing/output_compare.h"

#include "emu/dspic/devices/register_bits.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kOCxCON{"OC?CON"};
enum Mode : int { kOff = 0, kHigh, kLow, kToggle, kPulse, kPulses, kPwm, kPwmFault };

constexpr std::uint16_t kUnitBytes = 6;

}  // namespace

OutputCompare::OutputCompare(const Surroundings& around, const Setup& setup, std::array<Timer*, 2> timers,
                             Ports& ports, Pins& pins)
    : around_(around),
      setup_(setup),
      units_(setup.units),
      bases_{Base{this, timers[0]}, Base{this, timers[1]}},
      faults_{FaultInput{this, 0, kFirstOfB - 1}, FaultInput{this, kFirstOfB, setup.units.size() - 1}},
      ports_(ports),
      pins_(pins),
      states_(setup.units.size()),
      slot_(around.events.add(this, due)) {
    for (const Unit& unit : units_) {
        around_.sfr.hook(unit.rs, this, nullptr, write_rs);
        around_.sfr.mark_idempotent(unit.rs);
        around_.sfr.hook(static_cast<std::uint16_t>(unit.rs + 2), this, nullptr, write_r);
        around_.sfr.hook(static_cast<std::uint16_t>(unit.rs + 4), this, nullptr, write_con);
    }
    for (Base& base : bases_)
        base.timer->serve(&base, timer_changed, period_over);
    for (std::size_t i = 0; i < faults_.size(); ++i)
        ports_.listen(setup_.fault[i].port, setup_.fault[i].number, &faults_[i], fault_changed);
}

void OutputCompare::reset() {
    used_ = false;
    around_.events.cancel(slot_);
    for (std::size_t i = 0; i < units_.size(); ++i) {
        const OutputCompareState reported = states_[i].reported;
        states_[i] = {};
        states_[i].reported = reported;
        notify_board(i, around_.now);
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
    state.level = states_[index].level && !pwm(index);
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

// Notifies the board if what it knows has changed. A level that moves by itself, edge by edge, is at the pin.
void OutputCompare::notify_board(std::size_t index, Cycle at) {
    OutputCompareState now = present(static_cast<int>(index) + 1);
    if (now.period) now.level = false;
    if (now == states_[index].reported) return;
    states_[index].reported = now;
    pins_.output_compare_changed(static_cast<int>(index) + 1, at);
}

void OutputCompare::drive(std::size_t index, Cycle at) {
    const std::uint16_t pin = bit(units_[index].pin);
    if (mode(index) == kOff)
        ports_.release(units_[index].port, pin);
    else if (faulted(index))
        ports_.take_over(units_[index].port, pin, 0, 0, at);
    else
        ports_.take_over(units_[index].port, pin, pin, states_[index].level ? pin : 0, at);
}

void OutputCompare::begin(std::size_t index) {
    State& state = states_[index];
    const Cycle at = around_.now + 1;
    used_ |= mode(index) != kOff;
    state.glitch = state.missed = false;
    state.step = mode(index) == kOff || (pwm(index) && !pwm_edges(index)) ? Step::Idle : Step::First;
    if (mode(index) != kToggle) state.level = mode(index) == kLow;
    if (pwm_edges(index)) state.level = r(index) != 0;
    if (pwm(index)) timer(index).want_period();
    if (mode(index) == kPwmFault) {
        const Ports::Pin& input = setup_.fault[index < kFirstOfB ? 0 : 1];
        ports_.attend(input.port, input.number);
        if (!ports_.digital_level(input.port, input.number)) return fault(index, at);
    }
    drive(index, at);
    plan(index, at);
}

// The match after cycle `from`, and the edge that it makes.
void OutputCompare::plan(std::size_t index, Cycle from) {
    State& state = states_[index];
    state.due = kNoCycle;
    if (state.step != Step::Idle && !state.held) {
        const Cycle match = timer(index).next_at(state.step == Step::First ? r(index) : rs(index), from);
        if (match != kNoCycle) state.due = match + (pwm(index) ? 0 : setup_.pin_delay);
    }
    plan_all();
}

void OutputCompare::plan_all() {
    Cycle first = kNoCycle;
    for (const State& state : states_)
        first = std::min({first, state.due, state.interrupt});
    around_.events.schedule(slot_, first);
}

void OutputCompare::edge(std::size_t index, Cycle at) {
    State& state = states_[index];
    const bool first = state.step == Step::First;
    bool interrupt = true;
    Cycle match = at - setup_.pin_delay;
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
    case kPulse:
    case kPulses:
        state.level = first;
        interrupt = !first;
        state.step = first ? Step::Second : mode(index) == kPulse ? Step::Idle : Step::First;
        break;
    default:  // PWM: the duty is over
        state.level = state.glitch = false;
        interrupt = false;
        match = at;
        break;
    }
    drive(index, at);
    if (interrupt && setup_.flag_delay == 0) around_.interrupts.raise(units_[index].irq, at);
    if (interrupt && setup_.flag_delay != 0) state.interrupt = at + setup_.flag_delay;
    plan(index, match);
    notify_board(index, at);
}

void OutputCompare::due(void* owner, Cycle due) {
    OutputCompare& self = *static_cast<OutputCompare*>(owner);
    for (std::size_t i = 0; i < self.states_.size(); ++i) {
        State& state = self.states_[i];
        if (state.interrupt <= due) {
            state.interrupt = kNoCycle;
            self.around_.interrupts.raise(self.units_[i].irq, due);
        }
        if (state.due <= due) self.edge(i, due);
    }
    self.plan_all();
}

void OutputCompare::timer_changed(void* owner, Cycle at) {
    const Base& base = *static_cast<Base*>(owner);
    OutputCompare& self = *base.self;
    if (!self.used_) return;
    for (std::size_t i = 0; i < self.units_.size(); ++i) {
        if (self.mode(i) == kOff || &self.timer(i) != base.timer) continue;
        self.replan(i, at);
        self.notify_board(i, at);
    }
}

// After a write; an edge whose match was before it still comes.
void OutputCompare::replan(std::size_t index, Cycle at) {
    const State& state = states_[index];
    if (state.glitch) return;
    const Cycle delay = pwm(index) ? 0 : setup_.pin_delay;
    const bool matched = state.due != kNoCycle && state.due < at + delay;
    if (state.step != Step::Idle && !matched) plan(index, at);
}

void OutputCompare::set_hold(bool sleeps, bool idles) {
    for (std::size_t i = 0; i < units_.size(); ++i) {
        const bool held = sleeps || (idles && (con(i) & kOCxCON["OCSIDL"]));
        if (states_[i].held == held) continue;
        states_[i].held = held;
        plan(i, around_.now);
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
        self.replan(index, self.around_.now + 1);
        self.notify_board(index, self.around_.now + 1);
    }
}

void OutputCompare::write_r(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    OutputCompare& self = *static_cast<OutputCompare*>(owner);
    const std::size_t index = self.index_of(address);
    if (self.pwm(index)) return;  // read only then
    self.around_.sfr.store(address, value, mask);
    if (self.states_[index].step == Step::Idle) return;
    self.replan(index, self.around_.now + 1);
    self.notify_board(index, self.around_.now + 1);
}

void OutputCompare::write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    OutputCompare& self = *static_cast<OutputCompare*>(owner);
    const std::size_t index = self.index_of(address);
    const std::uint16_t old = self.con(index);
    self.around_.sfr.store(address, value, static_cast<std::uint16_t>(mask & ~kOCxCON["OCFLT"]));
    // The same mode again starts a single pulse anew, and PWM after a fault.
    const bool again = (self.mode(index) == kPulse && self.states_[index].step == Step::Idle) ||
                       (self.mode(index) == kPwmFault && self.faulted(index));
    if (self.con(index) == old && !again) return;
    assign(self.con(index), kOCxCON["OCFLT"], false);
    self.begin(index);
    self.notify_board(index, self.around_.now + 1);
}

}  // namespace puckloop::dspic
