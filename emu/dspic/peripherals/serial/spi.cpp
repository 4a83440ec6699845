#include "emu/dspic/peripherals/serial/spi.h"

#include "emu/dspic/devices/register_bits.h"

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kSPIxSTAT{"SPI?STAT"};
constexpr RegisterBits kSPIxCON{"SPI?CON*"};  // in the same place on both families, but for the framing
constexpr RegisterBits kFrame30F{"SPI?CON"};
constexpr RegisterBits kFrame33F{"SPI?CON2"};
constexpr RegisterBits kClock33F{"SPI?CON1"};
constexpr unsigned kPrimary[] = {64, 16, 4, 1};  // PPRE
constexpr unsigned kSecondaryMost = 8;           // SPRE = 0

}  // namespace

Spi::Spi(const Surroundings& around, const Setup& setup, Ports& ports, Pins& pins)
    : around_(around), setup_(setup), ports_(ports), pins_(pins), slot_(around.events.add(this, due)) {
    around_.sfr.hook(setup_.stat, this, nullptr, write_stat);
    around_.sfr.hook(static_cast<std::uint16_t>(setup_.stat + 2), this, nullptr, write_con);
    if (setup_.con2) around_.sfr.hook(setup_.con2, this, nullptr, write_con);
    around_.sfr.hook(setup_.buf, this, read_buf, write_buf);
    around_.sfr.hook_quiet(setup_.buf, this, look_at_buf);
    ports_.listen(setup_.port, setup_.sck, this, clock_edge);
    ports_.listen(setup_.ss.port, setup_.ss.number, this, select_edge);
}

void Spi::reset() {
    state_ = {};
    around_.events.cancel(slot_);
}

bool Spi::enabled() const {
    return stat() & kSPIxSTAT["SPIEN"];
}
bool Spi::master() const {
    return con() & kSPIxCON["MSTEN"];
}
int Spi::bits() const {
    return con() & kSPIxCON["MODE16"] ? 16 : 8;
}
Cycle Spi::clock_cycles() const {
    return kPrimary[kSPIxCON["PPRE"].of(con())] * (kSecondaryMost - kSPIxCON["SPRE"].of(con()));
}

bool Spi::framed() const {
    return setup_.con2 ? around_.sfr.raw(setup_.con2) & kFrame33F["FRMEN"] : con() & kFrame30F["FRMEN"];
}
bool Spi::frame_slave() const {
    return framed() &&
           (setup_.con2 ? around_.sfr.raw(setup_.con2) & kFrame33F["SPIFSD"] : con() & kFrame30F["SPIFSD"]);
}
bool Spi::pulse_high() const {
    return !setup_.con2 || (around_.sfr.raw(setup_.con2) & kFrame33F["FRMPOL"]);
}
bool Spi::pulse_with_word() const {
    return setup_.con2 && (around_.sfr.raw(setup_.con2) & kFrame33F["FRMDLY"]);
}
bool Spi::uses_select() const {
    return framed() || (!master() && (con() & kSPIxCON["SSEN"]));
}

void Spi::hold(bool on) {
    if (state_.held == on) return;
    state_.held = on;
    if (!on || !master()) return;
    state_.shifting = false;
    state_.pulse = false;
    around_.events.cancel(slot_);
}

// Between a master's words SCK and SDO rest, SCK at its idle level. A slave's SDO is driven while it is
// selected.
void Spi::take_over_pins(Cycle at) {
    const std::uint16_t sck = bit(setup_.sck);
    const std::uint16_t sdo = bit(setup_.sdo);
    const auto all = static_cast<std::uint16_t>(sck | bit(setup_.sdi) | sdo);
    const std::uint16_t ss = bit(setup_.ss.number);
    ports_.release(setup_.port, all);
    if (!enabled() || !uses_select()) {
        if (ports_.taken_over(setup_.ss.port) & ss) ports_.release(setup_.ss.port, ss);
    } else {
        const bool gives = framed() && !frame_slave();
        ports_.take_over(setup_.ss.port, ss, gives ? ss : 0, state_.pulse == pulse_high() ? ss : 0, at);
    }
    if (!enabled()) return;
    std::uint16_t taken_over = all;
    if (setup_.con2 && (con() & kClock33F["DISSCK"]))
        taken_over = static_cast<std::uint16_t>(taken_over & ~sck);
    if (con() & kSPIxCON["DISSDO"]) taken_over = static_cast<std::uint16_t>(taken_over & ~sdo);
    std::uint16_t output = taken_over & static_cast<std::uint16_t>((master() ? sck : 0) | sdo);
    if (!master() && !slave_drives()) output = static_cast<std::uint16_t>(output & ~sdo);
    ports_.take_over(setup_.port, taken_over, output, con() & kSPIxCON["CKP"] ? sck : 0, at);
}

// ---- master

// A framed word begins at an edge of the clock, and has a clock for the pulse in front of it.
void Spi::begin(std::uint16_t value, Cycle from) {
    state_.shifting = true;
    state_.shift = value;
    const Cycle word = clock_cycles() * static_cast<Cycle>(bits());
    if (!framed()) return around_.events.schedule(slot_, from + word);
    if (frame_slave() && !state_.framed) return;  // until the pulse comes
    state_.framed = false;
    const Cycle late = (from - state_.phase) % clock_cycles();
    const Cycle start = from + (late ? clock_cycles() - late : 0);
    const Cycle first = start + (pulse_with_word() || frame_slave() ? 0 : clock_cycles());
    state_.word_end = first + word;
    state_.pulse_at = frame_slave() ? kNoCycle : start;
    around_.events.schedule(slot_, frame_slave() ? state_.word_end : start);
}

void Spi::due(void* owner, Cycle due) {
    Spi& self = *static_cast<Spi*>(owner);
    State& state = self.state_;
    if (state.pulse_at == due) {  // the pulse of the frame begins, one clock long
        state.pulse_at = kNoCycle;
        state.pulse = true;
        self.take_over_pins(due);
        return self.around_.events.schedule(self.slot_, due + self.clock_cycles());
    }
    if (state.pulse) {
        state.pulse = false;
        self.take_over_pins(due);
        if (due < state.word_end) return self.around_.events.schedule(self.slot_, state.word_end);
    }
    const int bits = self.bits();
    const std::uint16_t mask = bits == 16 ? 0xFFFF : 0x00FF;
    const auto sent = static_cast<std::uint16_t>(state.shift & mask);
    const auto got = self.pins_.spi_exchange(self.setup_.unit, sent, bits, due) & mask;
    state.shifting = false;
    self.finish_word(static_cast<std::uint16_t>(got), due);
    if (self.stat() & kSPIxSTAT["SPITBF"]) {
        assign(self.stat(), kSPIxSTAT["SPITBF"], false);
        self.begin(state.waiting, due);
    }
    self.around_.interrupts.raise(self.setup_.irq, due);
}

void Spi::finish_word(std::uint16_t got, Cycle at) {
    if (stat() & kSPIxSTAT["SPIRBF"]) {  // nobody fetched the last word: this one is lost
        stat() |= kSPIxSTAT["SPIROV"];
        if (setup_.error_irq != 255) around_.interrupts.raise(setup_.error_irq, at);
    } else {
        state_.received = got;
        stat() |= kSPIxSTAT["SPIRBF"];
    }
}

// ---- registers

std::uint16_t Spi::look_at_buf(void* owner, std::uint16_t) {
    return static_cast<const Spi*>(owner)->state_.received;
}

std::uint16_t Spi::read_buf(void* owner, std::uint16_t) {
    Spi& self = *static_cast<Spi*>(owner);
    assign(self.stat(), kSPIxSTAT["SPIRBF"], false);
    return self.state_.received;
}

void Spi::write_buf(void* owner, std::uint16_t, std::uint16_t value, std::uint16_t mask) {
    Spi& self = *static_cast<Spi*>(owner);
    std::uint16_t& stat = self.stat();
    if (!self.enabled() || mask == 0xFF00 || (self.master() && self.state_.held)) return;
    if (self.master() && !self.state_.shifting) return self.begin(value & mask, self.around_.now + 1);
    if (stat & kSPIxSTAT["SPITBF"]) return;
    self.state_.waiting = value & mask;
    stat |= kSPIxSTAT["SPITBF"];
    if (!self.master()) self.take_word();
}

void Spi::write_stat(void* owner, std::uint16_t, std::uint16_t value, std::uint16_t mask) {
    Spi& self = *static_cast<Spi*>(owner);
    std::uint16_t& stat = self.stat();
    const std::uint16_t old = stat;
    stat = merge(stat, value, static_cast<std::uint16_t>(mask & (kSPIxSTAT["SPIEN"] | kSPIxSTAT["SPISIDL"])));
    if ((mask & kSPIxSTAT["SPIROV"]) && !(value & kSPIxSTAT["SPIROV"]))
        assign(stat, kSPIxSTAT["SPIROV"], false);
    if (!((old ^ stat) & kSPIxSTAT["SPIEN"])) return;
    if (!self.enabled()) {
        const bool held = self.state_.held;
        self.reset();
        self.state_.held = held;
        stat = static_cast<std::uint16_t>(stat &
                                          ~(kSPIxSTAT["SPIROV"] | kSPIxSTAT["SPITBF"] | kSPIxSTAT["SPIRBF"]));
    }
    self.state_.phase = self.around_.now + 1;
    self.attend_slave();
    self.take_over_pins(self.around_.now + 1);
}

void Spi::write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Spi& self = *static_cast<Spi*>(owner);
    self.around_.sfr.store(address, value, mask);
    if (!self.enabled()) return;
    self.attend_slave();
    self.take_over_pins(self.around_.now + 1);
}

}  // namespace puckloop::dspic
