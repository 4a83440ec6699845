#include "emu/dspic/peripherals/timing/timer.h"

#include "emu/dspic/devices/register_bits.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {
constexpr RegisterBits kTxCON{"T?CON"};
constexpr std::uint32_t kPrescale[] = {1, 8, 64, 256};  // TCKPS
}  // namespace

Timer::Timer(const Surroundings& around, const Setup& setup, Timer* upper)
    : around_(around), setup_(setup), upper_(upper), slot_(around.events.add(this, match_due)) {
    around_.sfr.hook(setup_.tmr, this, read_tmr, write_tmr);
    around_.sfr.hook(setup_.pr, this, nullptr, write_pr);
    around_.sfr.hook(setup_.con, this, nullptr, write_con);
    if (setup_.hold) around_.sfr.claim(setup_.hold);
    if (upper_) upper_->lower_ = this;
}

void Timer::reset() {
    const bool pin = state_.pin;
    state_ = {};
    state_.pin = pin;
    state_.base = around_.now;
    around_.events.cancel(slot_);
}

bool Timer::paired() const {
    return upper_ && (con() & kTxCON["T32"]);
}
bool Timer::is_upper_half() const {
    return lower_ && lower_->paired();
}
int Timer::irq() const {
    return paired() ? upper_->setup_.irq : setup_.irq;
}
bool Timer::external() const {
    return con() & kTxCON["TCS"];
}
bool Timer::synchronised() const {
    return !setup_.asynchronous || (con() & kTxCON["TSYNC"]);
}
bool Timer::gated() const {
    return !external() && (con() & kTxCON["TGATE"]);
}
bool Timer::monitors_clock_pin() const {
    return (con() & kTxCON["TON"]) && !is_upper_half() && (external() || gated());
}
bool Timer::running() const {
    return (con() & kTxCON["TON"]) && !state_.held && !is_upper_half() && !external() &&
           (!gated() || state_.pin);
}
std::uint32_t Timer::prescale() const {
    return kPrescale[kTxCON["TCKPS"].of(con())];
}
std::uint32_t Timer::period() const {
    const std::uint32_t low = around_.sfr.raw(setup_.pr);
    return paired() ? low | static_cast<std::uint32_t>(around_.sfr.raw(upper_->setup_.pr)) << 16 : low;
}

std::uint32_t Timer::count_at(Cycle at) const {
    if (!running() || at < state_.base) return state_.count;
    Cycle ticks = (at - state_.base + state_.fraction) / prescale();
    std::uint32_t count = state_.count;
    if (count > period()) {  // past the match: all the way round
        const Cycle to_wrap = static_cast<Cycle>(top()) - count + 1;
        if (ticks < to_wrap) return static_cast<std::uint32_t>(count + ticks);
        ticks -= to_wrap;
        count = 0;
    }
    return static_cast<std::uint32_t>((count + ticks) % (static_cast<Cycle>(period()) + 1));
}

Cycle Timer::next_match() const {
    if (!running() || gated() || period() == 0) return kNoCycle;
    Cycle ticks = static_cast<Cycle>(period()) + 1 - state_.count;
    if (state_.count > period()) ticks = static_cast<Cycle>(top()) + 1 - state_.count + period() + 1;
    return state_.base + ticks * prescale() - state_.fraction;
}

Cycle Timer::next_at(std::uint32_t value, Cycle from) const {
    if (!running() || gated() || value > period() || period() == 0) return kNoCycle;
    const Cycle start = std::max(from, state_.base);
    const std::uint32_t count = count_at(start);
    Cycle ticks = (start - state_.base + state_.fraction) / prescale();
    if (count > period())
        ticks += static_cast<Cycle>(top()) + 1 - count + value;
    else
        ticks += value > count ? value - count : static_cast<Cycle>(period()) + 1 - count + value;
    return state_.base + ticks * prescale() - state_.fraction;
}

void Timer::serve(void* owner, void (*changed)(void*, Cycle), void (*period)(void*, Cycle)) {
    served_ = owner;
    changed_ = changed;
    period_ = period;
}

void Timer::settle(Cycle at) {
    while (around_.events.due(slot_) <= at)
        match_due(this, around_.events.due(slot_));
    if (running() && at > state_.base) {
        const std::uint32_t count = count_at(at);
        state_.fraction = static_cast<std::uint32_t>((at - state_.base + state_.fraction) % prescale());
        state_.count = count;
    }
    state_.base = at;
}

void Timer::plan() {
    wake(around_.now);
    const Cycle next = next_match();
    state_.reload = next == kNoCycle ? 0 : period_cycles();
    around_.events.schedule(slot_, next);
    announce_steady();
}

bool Timer::steady() const {
    const Timer& source = paired() ? *upper_ : *this;
    return state_.reload && !source.on_match && !period_wanted_;
}

void Timer::announce_steady() {
    EventQueue::Steady announced;
    if (steady()) announced = {irq(), state_.reload, matches_passed};
    around_.events.set_steady(slot_, announced);
}

void Timer::watch_flag() {
    around_.interrupts.rest(irq(), this,
                            [](void* owner, Cycle passed) { static_cast<Timer*>(owner)->wake(passed); });
}

void Timer::wake(Cycle passed) {
    if (!resting()) return;
    const Cycle first = next_match();
    if (first > passed) return around_.events.schedule(slot_, first);
    around_.events.schedule(slot_, first);
    matches_passed(this, (passed - first) / state_.reload + 1);
}

void Timer::matches_passed(void* owner, std::uint64_t times) {
    Timer& self = *static_cast<Timer*>(owner);
    const Cycle last = self.around_.events.due(self.slot_) + (times - 1) * self.state_.reload;
    self.state_.count = 0;
    self.state_.fraction = 0;
    self.state_.base = last;
    self.around_.events.schedule(self.slot_, last + self.state_.reload);
}

void Timer::match(Cycle at) {
    around_.interrupts.raise(irq(), at);
    Timer& source = paired() ? *upper_ : *this;
    if (source.on_match) source.on_match(source.on_match_owner, at);
}

void Timer::match_due(void* owner, Cycle due) {
    Timer& self = *static_cast<Timer*>(owner);
    self.state_.count = 0;
    self.state_.fraction = 0;
    self.state_.base = due;
    if (self.state_.reload)
        self.around_.events.schedule(self.slot_, due + self.state_.reload);
    else
        self.plan();
    self.match(due);
    if (self.around_.interrupts.is_deaf(self.irq()) && self.steady()) {
        self.around_.events.cancel(self.slot_);
        self.watch_flag();
    }
    if (self.period_wanted_) {
        self.period_wanted_ = false;
        self.period_(self.served_, due);
        self.announce_steady();
    }
}

void Timer::clock_pin(bool level, Cycle at) {
    if (at == kNoCycle) {
        state_.pin = level;
        return;
    }
    if ((con() & kTxCON["TON"]) && !is_upper_half()) {
        if (gated()) {
            settle(at);
            if (!level) match(at);
        } else if (external() && level && !(state_.held && synchronised()) &&
                   ++state_.fraction >= prescale()) {
            state_.fraction = 0;
            const bool back_to_zero = state_.count == period() || state_.count == top();
            state_.count = back_to_zero ? 0 : state_.count + 1;
            if (state_.count == period() && period() != 0) match(at);
        }
    }
    state_.pin = level;
    plan();
}

void Timer::hold(bool on) {
    if (state_.held == on) return;
    settle(around_.now);
    state_.held = on;
    plan();
    changed(around_.now);
}

void Timer::refresh() {
    std::uint16_t& stored = around_.sfr.raw(setup_.tmr);
    if (is_upper_half())
        stored = static_cast<std::uint16_t>(lower_->count_at(around_.now) >> 16);
    else
        stored = static_cast<std::uint16_t>(count_at(around_.now));
}

std::uint16_t Timer::read_tmr(void* owner, std::uint16_t) {
    Timer& self = *static_cast<Timer*>(owner);
    self.refresh();
    if (self.paired())
        self.around_.sfr.raw(self.setup_.hold) =
            static_cast<std::uint16_t>(self.count_at(self.around_.now) >> 16);
    return self.around_.sfr.raw(self.setup_.tmr);
}

void Timer::write_tmr(void* owner, std::uint16_t, std::uint16_t value, std::uint16_t mask) {
    Timer& self = *static_cast<Timer*>(owner);
    if (self.is_upper_half()) return;
    self.settle(self.around_.now + 1);
    const std::uint16_t low = merge(static_cast<std::uint16_t>(self.state_.count), value, mask);
    self.state_.count = low;
    if (self.paired())
        self.state_.count |= static_cast<std::uint32_t>(self.around_.sfr.raw(self.setup_.hold)) << 16;
    self.state_.fraction = 0;
    self.plan();
    self.changed(self.around_.now + 1);
}

void Timer::write_pr(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Timer& self = *static_cast<Timer*>(owner);
    Timer& counting = self.is_upper_half() ? *self.lower_ : self;
    counting.settle(self.around_.now + 1);
    self.around_.sfr.store(address, value, mask);
    counting.plan();
    counting.changed(self.around_.now + 1);
}

void Timer::write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Timer& self = *static_cast<Timer*>(owner);
    const bool was_paired = self.paired();
    const Cycle at = self.around_.now + 1;
    self.settle(at);
    if (self.upper_) self.upper_->settle(at);
    self.around_.sfr.store(address, value, mask);
    if (!(self.con() & kTxCON["TON"])) self.state_.fraction = 0;
    self.state_.fraction %= self.prescale();
    if (self.upper_ && self.paired() != was_paired) {  // the high word changes hands
        if (self.paired()) {
            self.state_.count |= self.upper_->state_.count << 16;
        } else {
            self.upper_->state_.count = self.state_.count >> 16;
            self.state_.count &= 0xFFFFu;
        }
    }
    self.plan();
    if (self.upper_) self.upper_->plan();
    self.changed(at);
    if (self.upper_) self.upper_->changed(at);
    if (self.on_monitoring) self.on_monitoring(self.on_monitoring_owner);
}

}  // namespace puckloop::dspic
