// The counter: what happens at which tick.

#include "emu/avr/peripherals/timing/timer.h"

#include <algorithm>

namespace puckloop::avr {

namespace {

// TIFRn
constexpr std::uint8_t kTov = bit(0), kOcfA = bit(1), kIcf = bit(5);
constexpr std::uint8_t ocf(int channel) {
    return static_cast<std::uint8_t>(kOcfA << channel);
}

using Kind = Waveform::Kind;
using Top = Waveform::Top;
/// WGMn3:0 of the 16-bit timers, WGMn2:0 of the 8-bit ones; reserved codes count as Normal.
constexpr Waveform kWide[16] = {{Kind::Normal, Top::Fixed, 0xFFFF},
                                {Kind::Phase, Top::Fixed, 0xFF},
                                {Kind::Phase, Top::Fixed, 0x1FF},
                                {Kind::Phase, Top::Fixed, 0x3FF},
                                {Kind::Ctc, Top::CompareA},
                                {Kind::Fast, Top::Fixed, 0xFF},
                                {Kind::Fast, Top::Fixed, 0x1FF},
                                {Kind::Fast, Top::Fixed, 0x3FF},
                                {Kind::PhaseFrequency, Top::Capture},
                                {Kind::PhaseFrequency, Top::CompareA},
                                {Kind::Phase, Top::Capture},
                                {Kind::Phase, Top::CompareA},
                                {Kind::Ctc, Top::Capture},
                                {Kind::Normal, Top::Fixed, 0xFFFF},
                                {Kind::Fast, Top::Capture},
                                {Kind::Fast, Top::CompareA}};
constexpr Waveform kNarrow[8] = {{Kind::Normal, Top::Fixed, 0xFF}, {Kind::Phase, Top::Fixed, 0xFF},
                                 {Kind::Ctc, Top::CompareA},       {Kind::Fast, Top::Fixed, 0xFF},
                                 {Kind::Normal, Top::Fixed, 0xFF}, {Kind::Phase, Top::CompareA},
                                 {Kind::Normal, Top::Fixed, 0xFF}, {Kind::Fast, Top::CompareA}};

/// COMnx1:0
enum OutputMode : unsigned { kDisconnected, kToggle, kClear, kSet };

}  // namespace

Waveform Timer::waveform() const {
    const unsigned low = field(control_a(), 1, 0);
    return setup_.wide ? kWide[low | field(control_b(), 4, 3) << 2]
                       : kNarrow[low | field(control_b(), 3, 3) << 2];
}

std::uint32_t Timer::top() const {
    const Waveform wave = waveform();
    if (wave.top == Top::CompareA) return state_.compare[0];
    return wave.top == Top::Capture ? state_.capture : wave.fixed;
}

std::uint32_t Timer::divider() const {
    return division_of(control_b());
}

std::uint32_t Timer::division_of(std::uint8_t control) const {
    if ((reg(setup_.power) & setup_.power_bit) || prescaler_.stopped()) return 0;
    return setup_.dividers[field(control, 2, 0)];
}

bool Timer::buffers_wait() const {
    return state_.buffered != state_.compare && waveform().buffered();
}

// Fast PWM updates at BOTTOM, phase correct at TOP, phase and frequency correct at BOTTOM.
std::uint64_t Timer::until_update() const {
    const Waveform wave = waveform();
    const std::uint32_t end = top();
    const Counter& c = state_.counter;
    if (wave.kind == Kind::Fast) return c.leaves(c.count > end ? max() : end, wave, end, max(), false);
    if (wave.kind == Kind::PhaseFrequency) {
        const std::uint64_t leaves = c.leaves(0, wave, end, max(), false);
        return leaves > 1 ? leaves - 1 : leaves + 2 * std::uint64_t{std::max(end, 1u)} - 1;
    }
    const std::uint64_t leaves = c.leaves(std::max(end, c.count), wave, end, max(), false);
    return leaves > 1 ? leaves - 1 : leaves + 2 * std::uint64_t{std::max(end, 1u)} - 1;
}

// Ticks until something has to happen by itself: a flag in `masks` that is not set, a pin, a buffer, the
// return from above the top.
std::uint64_t Timer::next_tick(std::uint8_t masks) const {
    const Waveform wave = waveform();
    const std::uint32_t end = top();
    const std::uint8_t wanted = masks & static_cast<std::uint8_t>(~flags_.flags());
    const auto leaves = [&](std::uint32_t value, bool blocked) {
        return state_.counter.leaves(value, wave, end, max(), blocked);
    };
    std::uint64_t first = kNoTick;
    const bool outputs = output_mode(0) != kDisconnected || output_mode(1) != kDisconnected;
    for (int channel = 0; channel < 2; ++channel)
        if ((wanted & ocf(channel)) || output_mode(channel) != kDisconnected)
            first =
                std::min(first, leaves(state_.compare[static_cast<std::size_t>(channel)], state_.blocked));
    if ((wanted & kTov) || (outputs && wave.buffered())) {
        if (wave.dual_slope())
            first = std::min(first, leaves(0, false));
        else if (wave.kind == Kind::Fast && state_.counter.count <= end)
            first = std::min(first, leaves(end, false));
        else
            first = std::min(first, leaves(max(), false));
    }
    if ((wanted & kIcf) && wave.top == Top::Capture) first = std::min(first, leaves(end, state_.blocked));
    if (buffers_wait()) first = std::min(first, until_update());
    if (wave.dual_slope() && state_.counter.count > end) first = std::min(first, leaves(0, false));
    return first;
}

void Timer::plan() {
    const std::uint32_t division = divider();
    const std::uint64_t tick = division ? next_tick(flags_.masks() | flags_.watched()) : kNoTick;
    around_.events.schedule(slot_, tick == kNoTick ? kNoCycle : prescaler_.tick(state_.at, tick, division));
}

void Timer::settle(Cycle now) {
    if (now <= state_.at) return;
    const std::uint32_t division = divider();
    const std::uint64_t ticks = division ? prescaler_.ticks(state_.at, now, division) : 0;
    state_.at = now;
    if (ticks) pass(ticks);
}

// What happens by itself is planned, so that it falls on the last of these ticks.
void Timer::pass(std::uint64_t ticks) {
    const Waveform wave = waveform();
    const std::uint32_t end = top();
    const Counter before = state_.counter;
    const auto leaves = [&](std::uint32_t value, bool blocked) {
        return before.leaves(value, wave, end, max(), blocked) <= ticks;
    };
    const bool update = buffers_wait() && until_update() <= ticks;
    std::array<bool, 2> matched{};
    std::uint8_t raised = 0;
    for (std::size_t channel = 0; channel < 2; ++channel) {
        matched[channel] = leaves(state_.compare[channel], state_.blocked);
        if (matched[channel]) raised |= ocf(static_cast<int>(channel));
    }
    bool from_top = false;  // to BOTTOM, not over MAX
    if (wave.dual_slope()) {
        if (leaves(0, false)) raised |= kTov;
    } else {
        const bool ran_over = leaves(max(), false) && (before.count > end || end == max());
        from_top = leaves(end, false);
        if (ran_over || (wave.kind == Kind::Fast && from_top)) raised |= kTov;
    }
    if (wave.top == Top::Capture && leaves(end, state_.blocked)) raised |= kIcf;
    state_.counter.advance(ticks, wave, end, max());
    state_.blocked = false;

    for (int channel = 0; channel < 2; ++channel)
        if (matched[static_cast<std::size_t>(channel)] && output_mode(channel) != kDisconnected) {
            const bool hidden = wave.kind == Kind::Fast && from_top &&  // a match at the top changes nothing
                                state_.compare[static_cast<std::size_t>(channel)] == end &&
                                output_mode(channel) != kToggle;
            if (hidden) continue;
            if (!wave.dual_slope()) {
                match(channel);
            } else {  // on the way up, or down: the top counts as down, the bottom as up
                const std::uint16_t value = state_.compare[static_cast<std::size_t>(channel)];
                Counter last = before;  // an output's match falls on the last tick
                last.advance(ticks - 1, wave, end, max());
                const bool down = value >= end || (last.down && value != 0);
                const unsigned mode = output_mode(channel);
                if (mode == kToggle)
                    match(channel);
                else
                    set_output(channel, (mode == kClear) == down);
            }
        }
    if (from_top && wave.kind == Kind::Fast) bottom();
    if (update) state_.compare = state_.buffered;
    if (raised & ~flags_.flags()) flags_.raise(raised);
}

// ---- outputs

void Timer::match(int channel) {
    const Waveform wave = waveform();
    const auto index = static_cast<std::size_t>(channel);
    switch (output_mode(channel)) {
    case kToggle:  // in PWM modes only OCnA, and only where OCRnA is the top
        if (!wave.buffered() || (channel == 0 && wave.top == Top::CompareA) ||
            (channel == 0 && wave.top == Top::Capture))
            set_output(channel, !state_.output[index]);
        break;
    case kClear:
        set_output(channel, false);
        break;
    case kSet:
        set_output(channel, true);
        break;
    default:
        break;
    }
}

// Fast PWM: the other half of the non-inverting and inverting modes, when the counter changes from TOP to
// BOTTOM. One that was written above TOP runs over MAX without it (docs/measured_silicon.md).
void Timer::bottom() {
    for (int channel = 0; channel < 2; ++channel) {
        if (output_mode(channel) == kClear) set_output(channel, true);
        if (output_mode(channel) == kSet) set_output(channel, false);
    }
}

void Timer::set_output(int channel, bool level) {
    const auto index = static_cast<std::size_t>(channel);
    if (state_.output[index] == level) return;
    state_.output[index] = level;
    if (output_mode(channel) != kDisconnected)
        ports_.override_value(setup_.outputs[index], level, PinUser::Compare);
}

void Timer::connect_outputs() {
    const Waveform wave = waveform();
    for (int channel = 0; channel < 2; ++channel) {
        const auto index = static_cast<std::size_t>(channel);
        const unsigned mode = output_mode(channel);
        const bool idle_toggle =
            mode == kToggle && wave.buffered() && (channel == 1 || wave.top == Top::Fixed);
        if (mode == kDisconnected || idle_toggle)
            ports_.release_value(setup_.outputs[index], PinUser::Compare);
        else
            ports_.override_value(setup_.outputs[index], state_.output[index], PinUser::Compare);
    }
}

// ---- events and captures

void Timer::due(void* owner, Cycle cycle) {
    auto& self = *static_cast<Timer*>(owner);
    self.settle(cycle);
    self.plan();
}

void Timer::synchronise() {
    settle(around_.now);
    plan();
}
void Timer::touched(void* owner) {
    static_cast<Timer*>(owner)->synchronise();
}

void Timer::do_capture(Cycle now) {
    if (waveform().top == Top::Capture) return;  // ICRn is the top: the pin is disconnected
    settle(now);
    state_.capture = static_cast<std::uint16_t>(state_.counter.count);
    flags_.raise(kIcf);
    plan();
}

// ICNCn: four equal samples, then the edge counts.
void Timer::capture_edge(bool rising) {
    constexpr std::uint8_t kIcnc = bit(7), kIces = bit(6);
    constexpr Cycle kNoiseClocks = 4;
    if (control_b() & kIcnc) {
        const bool pending = around_.events.due(noise_slot_) != kNoCycle;
        if (pending && state_.capture_rising != rising) return around_.events.cancel(noise_slot_);
        state_.capture_rising = rising;
        around_.events.schedule(noise_slot_, around_.now + kNoiseClocks);
    } else if (static_cast<bool>(control_b() & kIces) == rising) {
        do_capture(around_.now);
    }
}

void Timer::noise_over(void* owner, Cycle cycle) {
    auto& self = *static_cast<Timer*>(owner);
    constexpr std::uint8_t kIces = bit(6);
    if (static_cast<bool>(self.control_b() & kIces) == self.state_.capture_rising) self.do_capture(cycle);
}

void Timer::pins_changed(void* owner, PortLetter port, std::uint8_t before, std::uint8_t after, Cycle) {
    auto& self = *static_cast<Timer*>(owner);
    const auto edge = [&](const std::optional<Pin>& pin) {
        return pin && pin->port == port && ((before ^ after) & pin->mask());
    };
    if (edge(self.setup_.clock_pin)) {
        constexpr unsigned kFallingEdge = 6, kRisingEdge = 7;
        const bool rising = after & self.setup_.clock_pin->mask();
        const unsigned select = field(self.control_b(), 2, 0);
        const bool stopped = self.reg(self.setup_.power) & self.setup_.power_bit;
        if (!stopped && select == (rising ? kRisingEdge : kFallingEdge)) {
            self.state_.at = self.around_.now;
            self.pass(1);
        }
    }
    if (self.asynchronous() && self.watch_->uses_pin() && edge(self.setup_.watch_in) &&
        (after & self.setup_.watch_in.mask()))
        self.watch_edge();
    if (edge(self.setup_.capture_pin) && !self.state_.capture_by_comparator)
        self.capture_edge(after & self.setup_.capture_pin->mask());
}

}  // namespace puckloop::avr
