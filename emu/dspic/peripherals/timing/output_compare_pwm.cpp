// PWM at the pin, and the fault inputs.

#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/peripherals/timing/output_compare.h"

namespace puckloop::dspic {

namespace {
constexpr RegisterBits kOCxCON{"OC?CON"};
constexpr int kPwmFault = 7;
}  // namespace

bool OutputCompare::pwm_edges(std::size_t index) const {
    return pwm(index) && pins_.wants_pwm_edges(static_cast<int>(index) + 1);
}

// A new period takes its duty from OCxRS: the pin is high for so many counts, all of them beyond PRy.
void OutputCompare::period_over(void* owner, Cycle at) {
    const Base& base = *static_cast<Base*>(owner);
    OutputCompare& self = *base.self;
    for (std::size_t i = 0; i < self.units_.size(); ++i)
        if (self.pwm(i) && &self.timer(i) == base.timer) self.begin_period(i, at);
}

void OutputCompare::begin_period(std::size_t index, Cycle at) {
    const bool changed = r(index) != rs(index);
    r(index) = rs(index);
    if (pwm_edges(index)) {
        timer(index).want_period();
        State& state = states_[index];
        state.step = faulted(index) ? Step::Idle : Step::First;
        const bool acts = !state.held && !faulted(index);
        if (acts && changed && glitches_ && r(index) == 0) return begin_glitch(index, at);
        const bool high = r(index) != 0 && !state.missed;
        state.missed = false;
        if (acts && state.level != high) {
            state.level = high;
            drive(index, at);
        }
        plan(index, at);
    }
    if (changed) notify_board(index, at);
}

// Erratum::PwmZeroDuty
void OutputCompare::begin_glitch(std::size_t index, Cycle at) {
    State& state = states_[index];
    state.glitch = state.missed = true;
    state.level = true;
    drive(index, at);
    state.due = at + 1;
    plan_all();
    notify_board(index, at);
}

bool OutputCompare::faulted(std::size_t index) const {
    return con(index) & kOCxCON["OCFLT"];
}

// OCFA or OCFB is low: the pin floats until the mode is written again with the input high.
void OutputCompare::fault(std::size_t index, Cycle at) {
    State& state = states_[index];
    con(index) |= kOCxCON["OCFLT"];
    state.step = Step::Idle;
    state.level = state.glitch = state.missed = false;
    drive(index, at);
    plan(index, at);
    around_.interrupts.raise(units_[index].irq, at);
    notify_board(index, at);
}

void OutputCompare::fault_changed(void* owner, bool level, Cycle at) {
    const FaultInput& input = *static_cast<FaultInput*>(owner);
    OutputCompare& self = *input.self;
    if (at == kNoCycle || level) return;
    for (std::size_t i = input.first; i <= input.last; ++i)
        if (self.mode(i) == kPwmFault && !self.faulted(i)) self.fault(i, at);
}

}  // namespace puckloop::dspic
