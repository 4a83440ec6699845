#include "emu/dspic/peripherals/dci.h"

#include "emu/dspic/devices/register_bits.h"

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

constexpr unsigned kWholeWord = 16;    // bits
constexpr unsigned kAcLinkSlots = 13;  // one of 16 bits, twelve of 20
constexpr unsigned kAcLinkSlotBits = 20;

}  // namespace

Dci::Dci(const Surroundings& around, const Setup& setup, Ports& ports, Pins& pins)
    : around_(around), setup_(setup), ports_(ports), pins_(pins), slot_(around.events.add(this, due)) {
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
    } else {
        state_.begun += around_.now - state_.held_at;
        around_.events.schedule(slot_, end_of(state_.slot));
    }
}

/// This chip makes both clocks.
bool Dci::clocked() const {
    const unsigned con1 = reg(kCon1);
    return !(con1 & (kDCICON1["CSCKD"] | kDCICON1["COFSD"])) && reg(kCon3) != 0;
}

unsigned Dci::in_use() const {
    return kDCICON2["BLEN"].of(reg(kCon2)) + 1;
}

void Dci::lend_pins() {
    const auto all =
        static_cast<std::uint16_t>(bit(setup_.csdi) | bit(setup_.csdo) | bit(setup_.csck) | bit(setup_.cofs));
    ports_.give_back(setup_.port, all);
    const unsigned con1 = reg(kCon1);
    if (!(con1 & kDCICON1["DCIEN"])) return;
    std::uint16_t output = bit(setup_.csdo);
    if (!(con1 & kDCICON1["CSCKD"])) output |= bit(setup_.csck);
    if (!(con1 & kDCICON1["COFSD"])) output |= bit(setup_.cofs);
    ports_.lend(setup_.port, all, output, 0);
}

void Dci::start(Cycle from) {
    if (!clocked() || state_.running) return;
    state_.running = true;
    state_.next = 0;
    swap(from, false);
    // DJST = 0: data begins one bit behind the frame sync, in every frame.
    const Cycle delay = reg(kCon1) & kDCICON1["DJST"] ? 0 : 2 * (reg(kCon3) + Cycle{1});
    begin_frame(from + delay);
    if (!state_.held) return;
    state_.held_at = from;
    around_.events.cancel(slot_);
}

void Dci::begin_frame(Cycle from) {
    const unsigned con2 = reg(kCon2);
    const unsigned mode = kDCICON1["COFSM"].of(reg(kCon1));
    Frame& frame = state_.frame;
    frame.bit = 2 * (reg(kCon3) + 1u);
    frame.slots = static_cast<std::uint8_t>(kDCICON2["COFSG"].of(con2) + 1);
    frame.bits = static_cast<std::uint8_t>(kDCICON2["WS"].of(con2) + 1);
    frame.first = frame.word = frame.bit * frame.bits;
    if (mode == kAcLink16 || mode == kAcLink20) {
        frame.bits = kWholeWord;
        frame.first = frame.word = frame.bit * kWholeWord;
        frame.slots = kSlots;
    }
    if (mode == kAcLink16) {
        frame.word = frame.bit * kAcLinkSlotBits;
        frame.slots = kAcLinkSlots;
    }
    frame.transmit = reg(kTscon);
    frame.receive = reg(kRscon);
    state_.begun = from;
    plan(0);
}

/// The next event: the end of the first enabled slot from `from_slot` on, or the frame's.
void Dci::plan(unsigned from_slot) {
    const Frame& frame = state_.frame;
    const unsigned enabled = frame.transmit | frame.receive;
    unsigned slot = from_slot;
    while (slot < frame.slots && !(enabled >> slot & 1u))
        ++slot;
    state_.slot = static_cast<std::uint8_t>(slot);
    around_.events.schedule(slot_, end_of(slot));
}

/// When a slot is over; of `slots` on: the frame.
Cycle Dci::end_of(unsigned slot) const {
    const Frame& frame = state_.frame;
    const unsigned whole = slot < frame.slots ? slot : frame.slots - 1u;
    return state_.begun + frame.first + Cycle{whole} * frame.word;
}

void Dci::due(void* owner, Cycle due) {
    Dci& self = *static_cast<Dci*>(owner);
    const unsigned slot = self.state_.slot;
    if (slot < self.state_.frame.slots) self.exchange(due);
    if (!self.state_.running) return;  // the board may have reset the chip
    if (slot + 1u >= self.state_.frame.slots)
        self.clocked() ? self.begin_frame(due) : self.plan(0);
    else
        self.plan(slot + 1u);
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
    word.frame = state_.begun;
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
    const Cycle into = now > state.begun ? now - state.begun : 0;
    Cycle slot = into < state.frame.first ? 0 : 1 + (into - state.frame.first) / state.frame.word;
    if (slot >= state.frame.slots) slot = state.frame.slots - 1u;
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
        return self.lend_pins();
    }
    self.lend_pins();
    self.start(self.around_.now + 1);
}

void Dci::write_con3(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Dci& self = *static_cast<Dci*>(owner);
    self.around_.sfr.store(address, value, mask);
    if (self.reg(kCon1) & kDCICON1["DCIEN"]) self.start(self.around_.now + 1);
}

}  // namespace puckloop::dspic
