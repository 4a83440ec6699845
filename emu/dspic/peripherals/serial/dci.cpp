#include "emu/dspic/peripherals/serial/dci.h"

#include "emu/dspic/devices/register_bits.h"

#include <cmath>

namespace puckloop::dspic {

namespace {

enum Offset : int {
    kCon1 = 0,
    kCon2 = 2,
    kCon3 = 4,
    kStat = 6,
    kTscon = 8,
    kRscon = 12,
    kRxbuf = 16,
    kTxbuf = 24
};
constexpr RegisterBits kDCICON1{"DCICON1"}, kDCICON2{"DCICON2"}, kDCISTAT{"DCISTAT"};
enum FrameMode : unsigned { kMultichannel = 0, kI2s = 1, kAcLink16 = 2, kAcLink20 = 3 };

constexpr std::uint8_t kWholeWord = 16;    // bits
constexpr std::uint8_t kAcLinkSlots = 13;  // one of 16 bits, twelve of 20
constexpr std::uint8_t kAcLinkSlotBits = 20;

}  // namespace

Dci::Dci(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
         Pins& pins)
    : around_(around),
      setup_(setup),
      clock_(clock),
      ports_(ports),
      pins_(pins),
      master_(pins.dci_master()),
      slot_(around.events.add(this, due)) {
    const auto at = [&](int offset) { return static_cast<std::uint16_t>(setup_.con1 + offset); };
    around_.sfr.hook(at(kCon1), this, nullptr, write_con1);
    around_.sfr.claim(at(kCon2));
    around_.sfr.hook(at(kCon3), this, nullptr, write_con3);
    around_.sfr.hook(at(kStat), this, read_stat, write_nothing);
    around_.sfr.claim(at(kTscon));
    around_.sfr.claim(at(kRscon));
    for (unsigned i = 0; i < kBuffers; ++i) {
        const int word = static_cast<int>(2 * i);
        around_.sfr.hook(at(kRxbuf + word), this, read_rxbuf, write_nothing);
        around_.sfr.hook_quiet(at(kRxbuf + word), this, look_rxbuf);
        around_.sfr.hook(at(kTxbuf + word), this, nullptr, write_txbuf);
    }
}

void Dci::reset() {
    state_ = {};
    around_.events.cancel(slot_);
}

void Dci::hold(bool on) {
    if (state_.held == on) return;
    state_.held = on;
    if (!state_.running) return;
    if (on) {
        state_.held_at = around_.now;
        around_.events.cancel(slot_);
    } else if (state_.frame.external) {
        enter(around_.now);
    } else {
        state_.base += around_.now - state_.held_at;
        around_.events.schedule(slot_, event());
    }
}

bool Dci::runs_in_sleep() const {
    return reg(kCon1) & kDCICON1["CSCKD"];
}

void Dci::rate_changed() {
    if (state_.running && !state_.held && state_.frame.external) around_.events.schedule(slot_, event());
}

/// Somebody makes each of the two clocks.
bool Dci::clocked() const {
    const unsigned con1 = reg(kCon1);
    const bool bits = con1 & kDCICON1["CSCKD"] ? master_.bit > 0 : reg(kCon3) != 0;
    return bits && (!(con1 & kDCICON1["COFSD"]) || master_.frame_bits > 0);
}

unsigned Dci::in_use() const {
    return kDCICON2["BLEN"].of(reg(kCon2)) + 1;
}

void Dci::take_over_pins() {
    const auto all =
        static_cast<std::uint16_t>(bit(setup_.csdi) | bit(setup_.csdo) | bit(setup_.csck) | bit(setup_.cofs));
    ports_.release(setup_.port, all);
    const unsigned con1 = reg(kCon1);
    if (!(con1 & kDCICON1["DCIEN"])) return;
    std::uint16_t output = bit(setup_.csdo);
    if (!(con1 & kDCICON1["CSCKD"])) output |= bit(setup_.csck);
    if (!(con1 & kDCICON1["COFSD"])) output |= bit(setup_.cofs);
    ports_.take_over(setup_.port, all, output, 0);
}

/// DJST = 0: data begin one bit behind the frame sync, in every frame.
unsigned Dci::delay() const {
    return reg(kCon1) & kDCICON1["DJST"] ? 0 : 1;
}

void Dci::start(Cycle from) {
    if (!clocked() || state_.running) return;
    state_.running = true;
    state_.next = 0;
    swap(from, false);
    enter(from);
    if (!state_.held) return;
    state_.held_at = from;
    around_.events.cancel(slot_);
}

/// Goes by the clocks that the registers choose, from the first bit on that begins at `from` or later.
void Dci::enter(Cycle from) {
    state_.frame.external = (reg(kCon1) & kDCICON1["CSCKD"]) != 0;
    state_.frame.synced = (reg(kCon1) & kDCICON1["COFSD"]) != 0;
    state_.base = from;
    state_.base_bit = 0;
    state_.frame.bit = 2 * (reg(kCon3) + 1u);
    Bit sync = 0;
    if (state_.frame.external) {
        const cosim::Time passed = clock_.time_of(from) - master_.first;
        if (passed > 0) sync = static_cast<Bit>((passed + master_.bit - 1) / master_.bit);
    }
    await_frame(sync + delay());
}

/// Slot 0 begins with bit `earliest`, or behind the codec's next frame sync.
void Dci::await_frame(Bit earliest) {
    state_.begun = earliest;
    state_.waiting = state_.frame.synced || state_.frame.external;
    if (!state_.waiting) return begin_frame();
    if (state_.frame.synced) {
        const Bit syncs = (earliest - delay() + master_.frame_bits - 1) / master_.frame_bits;
        state_.begun = syncs * master_.frame_bits + delay();
    }
    around_.events.schedule(slot_, event());
}

void Dci::begin_frame() {
    const unsigned con2 = reg(kCon2);
    const unsigned mode = kDCICON1["COFSM"].of(reg(kCon1));
    Frame& frame = state_.frame;
    state_.waiting = false;
    if (frame.external) {
        constexpr double kPerSecond = 1e-12;
        frame.bit = static_cast<std::uint32_t>(
            std::llround(static_cast<double>(master_.bit) * kPerSecond * clock_.hertz()));
    } else {
        state_.base = cycle_of(state_.begun);
        state_.base_bit = state_.begun;
        frame.bit = 2 * (reg(kCon3) + 1u);
    }
    frame.slots = static_cast<std::uint8_t>(kDCICON2["COFSG"].of(con2) + 1);
    frame.bits = static_cast<std::uint8_t>(kDCICON2["WS"].of(con2) + 1);
    frame.first = frame.word = frame.bits;
    if (mode == kAcLink16 || mode == kAcLink20) {
        frame.first = frame.word = frame.bits = kWholeWord;
        frame.slots = kSlots;
    }
    if (mode == kAcLink16) {
        frame.word = kAcLinkSlotBits;
        frame.slots = kAcLinkSlots;
    }
    frame.transmit = reg(kTscon);
    frame.receive = reg(kRscon);
    plan(0);
}

/// A frame is over at cycle `at`.
void Dci::next_frame(Cycle at) {
    const Frame& frame = state_.frame;
    const unsigned con1 = reg(kCon1);
    if (!clocked()) {
        state_.running = false;
        return;
    }
    const bool as_before = frame.external == ((con1 & kDCICON1["CSCKD"]) != 0) &&
                           frame.synced == ((con1 & kDCICON1["COFSD"]) != 0);
    if (!as_before) return enter(at);
    state_.begun = after(frame.slots);
    // The codec's sync for the next frame may come with this one's last bit.
    frame.synced ? await_frame(state_.begun) : begin_frame();
}

/// The next event: the end of the first enabled slot from `from_slot` on, or the frame's.
void Dci::plan(unsigned from_slot) {
    const Frame& frame = state_.frame;
    const unsigned enabled = frame.transmit | frame.receive;
    unsigned slot = from_slot;
    while (slot < frame.slots && !(enabled >> slot & 1u))
        ++slot;
    state_.slot = static_cast<std::uint8_t>(slot);
    around_.events.schedule(slot_, event());
}

Cycle Dci::cycle_of(Bit bit) const {
    if (state_.frame.external)
        return clock_.first_cycle_at(master_.first + static_cast<cosim::Time>(bit) * master_.bit);
    return state_.base + (bit - state_.base_bit) * state_.frame.bit;
}

/// The first bit behind a slot; of `slots` on: behind the frame.
Dci::Bit Dci::after(unsigned slot) const {
    const Frame& frame = state_.frame;
    const unsigned whole = slot < frame.slots ? slot : frame.slots - 1u;
    return state_.begun + frame.first + Bit{whole} * frame.word;
}

Cycle Dci::event() const {
    return cycle_of(state_.waiting ? state_.begun : after(state_.slot));
}

void Dci::due(void* owner, Cycle due) {
    Dci& self = *static_cast<Dci*>(owner);
    if (self.state_.waiting) return self.begin_frame();
    const unsigned slot = self.state_.slot;
    if (slot < self.state_.frame.slots) self.exchange(due);
    if (!self.state_.running) return;  // the board may have reset the chip
    slot + 1u >= self.state_.frame.slots ? self.next_frame(due) : self.plan(slot + 1u);
}

void Dci::exchange(Cycle at) {
    const Frame& frame = state_.frame;
    const auto mask = static_cast<std::uint16_t>(0xFFFFu << (kWholeWord - frame.bits));
    const std::uint16_t here = bit(state_.slot);
    DciWord word;
    word.slot = state_.slot;
    word.bits = frame.bits;
    word.driven = (frame.transmit & here) != 0;
    word.value = word.driven ? static_cast<std::uint16_t>(state_.out[state_.next] & mask) : 0;
    word.frame = cycle_of(state_.begun);
    word.bit_cycles = frame.bit;
    std::uint16_t got = pins_.dci_exchange(word, at);
    if (reg(kCon1) & kDCICON1["DLOOP"]) got = word.value;
    state_.in[state_.next] = frame.receive & here ? static_cast<std::uint16_t>(got & mask) : 0;
    if (++state_.next >= in_use()) {
        state_.next = 0;
        swap(at, true);
    }
}

/// Buffers and shadows change places.
void Dci::swap(Cycle at, bool interrupt) {
    const unsigned count = in_use();
    const auto used = static_cast<std::uint8_t>((1u << count) - 1u);
    std::uint16_t& stat = reg(kStat);
    bool error = false;
    const auto starved = static_cast<std::uint8_t>(used & ~state_.written);
    const bool repeats = (reg(kCon1) & kDCICON1["UNFM"]) != 0;
    for (unsigned i = 0; i < count; ++i)
        state_.out[i] = starved >> i & 1u && !repeats ? 0 : reg(kTxbuf + static_cast<int>(2 * i));
    if (interrupt) {
        if (starved != 0 && reg(kTscon) != 0) {
            state_.starved = starved;
            error |= !(stat & kDCISTAT["TUNF"]);
            stat |= kDCISTAT["TUNF"];
        }
        if (reg(kRscon) != 0) {
            if (state_.unread & used) {
                error |= !(stat & kDCISTAT["ROV"]);
                stat |= kDCISTAT["ROV"];
            }
            for (unsigned i = 0; i < count; ++i)
                reg(kRxbuf + static_cast<int>(2 * i)) = state_.in[i];
            state_.unread = used;
            stat |= kDCISTAT["RFUL"];
        }
        around_.interrupts.raise(setup_.irq, at);
    }
    state_.written = 0;
    stat |= kDCISTAT["TMPTY"];
    if (error && setup_.error_irq != 0) around_.interrupts.raise(setup_.error_irq, at);
}

std::uint16_t Dci::read_stat(void* owner, std::uint16_t) {
    Dci& self = *static_cast<Dci*>(owner);
    const State& state = self.state_;
    std::uint16_t& stat = self.reg(kStat);
    assign(stat, kDCISTAT["SLOT"], false);
    if (!state.running) return stat;
    const Cycle now = state.held ? state.held_at : self.around_.now;
    unsigned slot = 0;
    while (!state.waiting && slot + 1u < state.frame.slots && now >= self.cycle_of(self.after(slot)))
        ++slot;
    stat |= static_cast<std::uint16_t>(slot << 8);
    return stat;
}

std::uint16_t Dci::look_rxbuf(void* owner, std::uint16_t address) {
    return static_cast<Dci*>(owner)->around_.sfr.raw(address);
}

std::uint16_t Dci::read_rxbuf(void* owner, std::uint16_t address) {
    Dci& self = *static_cast<Dci*>(owner);
    const int index = (address - self.setup_.con1 - kRxbuf) / 2;
    State& state = self.state_;
    state.unread = static_cast<std::uint8_t>(state.unread & ~(1u << index));
    if (!(state.unread & ((1u << self.in_use()) - 1u)))
        assign(self.reg(kStat), static_cast<std::uint16_t>(kDCISTAT["RFUL"] | kDCISTAT["ROV"]), false);
    return self.around_.sfr.raw(address);
}

void Dci::write_txbuf(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Dci& self = *static_cast<Dci*>(owner);
    const auto here = static_cast<std::uint8_t>(1u << (address - self.setup_.con1 - kTxbuf) / 2);
    self.around_.sfr.store(address, value, mask);
    self.state_.written |= here;
    std::uint16_t& stat = self.reg(kStat);
    assign(stat, kDCISTAT["TMPTY"], false);
    self.state_.starved = static_cast<std::uint8_t>(self.state_.starved & ~here);
    if (self.state_.starved == 0) assign(stat, kDCISTAT["TUNF"], false);
}

void Dci::write_con1(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Dci& self = *static_cast<Dci*>(owner);
    const std::uint16_t before = self.reg(kCon1);
    self.around_.sfr.store(address, value, mask);
    const std::uint16_t now = self.reg(kCon1);
    if (before == now) return;
    if (!(now & kDCICON1["DCIEN"])) {
        if (!(before & kDCICON1["DCIEN"])) return;
        const State old = self.state_;
        self.reset();
        self.state_.held = old.held;
        self.state_.written = old.written;
        self.reg(kStat) = 0;
        return self.take_over_pins();
    }
    self.take_over_pins();
    self.start(self.around_.now + 1);
}

void Dci::write_con3(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Dci& self = *static_cast<Dci*>(owner);
    self.around_.sfr.store(address, value, mask);
    if (self.reg(kCon1) & kDCICON1["DCIEN"]) self.start(self.around_.now + 1);
}

}  // namespace puckloop::dspic
