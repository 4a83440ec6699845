#include "emu/dspic/peripherals/timing/input_capture.h"

#include "emu/dspic/devices/register_bits.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kICxCON{"IC?CON"};
enum Mode : unsigned { kOff = 0, kBoth = 1, kFalling = 2, kRising = 3, kEach4 = 4, kEach16 = 5, kWake = 7 };
constexpr std::uint16_t kReadOnly = kICxCON["ICOV"] | kICxCON["ICBNE"];
constexpr Cycle kDelay = 1;  // from the edge to the capture

}  // namespace

InputCapture::InputCapture(const Surroundings& around, std::span<const Unit> units,
                           std::array<Timer*, 2> timers, const cosim::ClockDomain& clock, Ports& ports)
    : around_(around),
      units_(units),
      timers_(timers),
      clock_(clock),
      ports_(ports),
      inputs_(units.size()),
      states_(units.size()),
      slot_(around.events.add(this, due)) {
    for (std::size_t i = 0; i < units_.size(); ++i) {
        const Unit& unit = units_[i];
        inputs_[i] = {this, static_cast<std::uint8_t>(i)};
        around_.sfr.hook(unit.buf, this, read_buf, write_buf);
        around_.sfr.hook_quiet(unit.buf, this, look_at_buf);
        around_.sfr.hook(static_cast<std::uint16_t>(unit.buf + 2), this, nullptr, write_con);
        ports_.listen(unit.pin.port, unit.pin.number, &inputs_[i], pin_changed);
    }
}

void InputCapture::clear() {
    for (State& state : states_)
        state = {};
    pending_.clear();
    dozes_ = false;
}

void InputCapture::reset() {
    used_ = false;
    clear();
    around_.events.cancel(slot_);
}

unsigned InputCapture::mode(std::size_t index) const {
    return kICxCON["ICM"].of(con(index));
}

void InputCapture::set_hold(bool sleeps, bool idles) {
    dozes_ = sleeps || idles;
    for (std::size_t i = 0; i < states_.size(); ++i)
        states_[i].held = sleeps || (idles && (con(i) & kICxCON["ICSIDL"]));
}

// ---- edges

void InputCapture::pin_changed(void* owner, bool level, Cycle at) {
    const Input& input = *static_cast<Input*>(owner);
    if (at == kNoCycle || input.self->states_[input.unit].line) return;
    input.self->edge(input.unit, level, at);
}

void InputCapture::edge(std::size_t index, bool level, Cycle at) {
    State& state = states_[index];
    const unsigned mode = this->mode(index);
    if (mode == kWake) {  // an interrupt pin, in Sleep and Idle only
        if (dozes_ && level) around_.interrupts.raise(units_[index].irq, at);
        return;
    }
    if (state.held) return;
    switch (mode) {
    case kBoth:
        break;
    case kFalling:
        if (level) return;
        break;
    case kRising:
        if (!level) return;
        break;
    case kEach4:
    case kEach16:
        if (!level || ++state.edges < (mode == kEach4 ? 4 : 16)) return;
        state.edges = 0;
        break;
    default:
        return;
    }
    add({at + kDelay, static_cast<std::uint8_t>(index), false, false});
}

void InputCapture::add(const Pending& pending) {
    const auto later = [](const Pending& a, const Pending& b) { return a.at < b.at; };
    pending_.insert(std::upper_bound(pending_.begin(), pending_.end(), pending, later), pending);
    plan();
}

void InputCapture::plan() {
    around_.events.schedule(slot_, pending_.empty() ? kNoCycle : pending_.front().at);
}

void InputCapture::due(void* owner, Cycle due) {
    InputCapture& self = *static_cast<InputCapture*>(owner);
    while (!self.pending_.empty() && self.pending_.front().at <= due) {
        const Pending next = self.pending_.front();
        self.pending_.erase(self.pending_.begin());
        if (next.edge)
            self.edge(next.unit, next.level, next.at);
        else
            self.capture(next.unit, next.at);
    }
    self.plan();
}

void InputCapture::capture(std::size_t index, Cycle at) {
    State& state = states_[index];
    std::uint16_t& con = this->con(index);
    const unsigned mode = this->mode(index);
    const unsigned every = mode == kBoth ? 0 : kICxCON["ICI"].of(con);
    const bool lost = state.count == kDepth || (con & kICxCON["ICOV"]);
    if (!lost) {
        const Timer& timer = *timers_[con & kICxCON["ICTMR"] ? 0 : 1];
        state.words[(state.first + state.count) % kDepth] = timer.value_at(at);
        ++state.count;
        show(index);
    } else if (mode != kBoth) {
        con |= kICxCON["ICOV"];
    }
    if (lost && every != 0) return;
    if (++state.captures <= every) return;
    state.captures = 0;
    around_.interrupts.raise(units_[index].irq, at);
}

// ---- a UART's line

void InputCapture::take_line(int unit, bool on) {
    used_ |= on;
    states_[static_cast<std::size_t>(unit - 1)].line = on;
}

void InputCapture::line_frame(int unit, const cosim::UartFrame& frame, Cycle at) {
    const auto index = static_cast<std::size_t>(unit - 1);
    if (mode(index) == kOff) return;
    const auto cycle = [&](int bit) { return clock_.first_cycle_at(frame.start + bit * frame.bit_period); };
    const Cycle start = cycle(0);
    const auto edge_at = [&](int bit, bool level) {
        add({at + (cycle(bit) - start), static_cast<std::uint8_t>(index), true, level});
    };
    bool level = true;
    const int before_stop = 1 + frame.data_bits + (frame.parity ? 1 : 0);
    for (int bit = 0; bit <= before_stop; ++bit) {
        bool next = true;
        if (frame.is_break)
            next = bit == before_stop;
        else if (bit == 0)
            next = false;
        else if (bit <= frame.data_bits)
            next = frame.data >> (bit - 1) & 1;
        else if (bit < before_stop)
            next = frame.parity_bit;
        if (next != level) edge_at(bit, next);
        level = next;
    }
}

// ---- registers

// ICBNE, and ICOV, which the read of the last word clears.
void InputCapture::show(std::size_t index) {
    std::uint16_t& con = this->con(index);
    assign(con, kICxCON["ICBNE"], states_[index].count != 0);
    if (states_[index].count == 0) assign(con, kICxCON["ICOV"], false);
}

std::uint16_t InputCapture::look_at_buf(void* owner, std::uint16_t address) {
    const InputCapture& self = *static_cast<const InputCapture*>(owner);
    const State& state = self.states_[self.index_of(address)];
    return state.count ? state.words[state.first] : state.last;
}

std::uint16_t InputCapture::read_buf(void* owner, std::uint16_t address) {
    InputCapture& self = *static_cast<InputCapture*>(owner);
    const std::size_t index = self.index_of(address);
    State& state = self.states_[index];
    if (state.count == 0) return state.last;
    state.last = state.words[state.first];
    state.first = static_cast<std::uint8_t>((state.first + 1) % kDepth);
    --state.count;
    self.show(index);
    return state.last;
}

void InputCapture::write_buf(void*, std::uint16_t, std::uint16_t, std::uint16_t) {}  // read only

void InputCapture::write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    InputCapture& self = *static_cast<InputCapture*>(owner);
    const std::size_t index = self.index_of(address);
    self.around_.sfr.store(address, value, static_cast<std::uint16_t>(mask & ~kReadOnly));
    State& state = self.states_[index];
    if (self.mode(index) != kOff) {
        self.used_ = true;
        self.ports_.attend(self.units_[index].pin.port, self.units_[index].pin.number);
        return;
    }
    const bool held = state.held, line = state.line;  // off: buffer, flags and prescaler are cleared
    state = {};
    state.held = held;
    state.line = line;
    std::erase_if(self.pending_, [&](const Pending& pending) { return pending.unit == index; });
    self.plan();
    self.show(index);
}

}  // namespace puckloop::dspic
