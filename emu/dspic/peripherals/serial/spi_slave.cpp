// The SPI module as a slave, bit by bit at its pins. CKE = 0: SDO changes with the edge that leaves the idle
// level of SCK and SDI is taken with the one that returns to it; CKE = 1: the other way round, the first bit
// stands at SDO before the first edge.

#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/peripherals/serial/spi.h"

namespace puckloop::dspic {

namespace {
constexpr RegisterBits kSPIxSTAT{"SPI?STAT"};
constexpr RegisterBits kSPIxCON{"SPI?CON*"};
}  // namespace

void Spi::attend_slave() {
    if (!enabled()) return;
    if (!master()) ports_.attend(setup_.port, setup_.sck);
    if ((!master() && uses_select()) || frame_slave()) ports_.attend(setup_.ss.port, setup_.ss.number);
}

bool Spi::selected() const {
    if (framed()) return state_.framed || state_.clocked > 0 || !frame_slave();
    return !(con() & kSPIxCON["SSEN"]) || !ports_.digital_level(setup_.ss.port, setup_.ss.number);
}

bool Spi::slave_drives() const {
    return framed() || selected();
}

// What waits moves into the shift register between words.
void Spi::take_word() {
    if (state_.clocked != 0 || !(stat() & kSPIxSTAT["SPITBF"])) return;
    assign(stat(), kSPIxSTAT["SPITBF"], false);
    state_.shift = state_.waiting;
    if (con() & kSPIxCON["CKE"]) drive_bit(around_.now + 1);
}

void Spi::clear_word() {
    state_.clocked = 0;
    state_.framed = false;
}

// The highest bit of the shift register.
void Spi::drive_bit(Cycle at) {
    const std::uint16_t sdo = bit(setup_.sdo);
    if (con() & kSPIxCON["DISSDO"]) return;
    const bool one = state_.shift >> (bits() - 1) & 1;
    ports_.take_over(setup_.port, sdo, slave_drives() ? sdo : 0, one ? sdo : 0, at);
}

void Spi::clock_edge(void* owner, bool level, Cycle at) {
    Spi& self = *static_cast<Spi*>(owner);
    if (at == kNoCycle || !self.enabled() || self.master() || !self.selected()) return;
    State& state = self.state_;
    const std::uint16_t con = self.con();
    const bool leaves_idle = level != static_cast<bool>(con & kSPIxCON["CKP"]);
    const bool samples = leaves_idle == static_cast<bool>(con & kSPIxCON["CKE"]);
    if (!samples) {
        if (state.clocked > 0 || !(con & kSPIxCON["CKE"])) self.drive_bit(at + 1);
        return;
    }
    const bool in = self.ports_.digital_level(self.setup_.port, self.setup_.sdi);
    state.shift = static_cast<std::uint16_t>(state.shift << 1 | (in ? 1 : 0));
    if (++state.clocked < self.bits()) return;
    self.clear_word();
    const std::uint16_t mask = self.bits() == 16 ? 0xFFFF : 0x00FF;
    self.finish_word(state.shift & mask, at);
    self.around_.interrupts.raise(self.setup_.irq, at);
    self.take_word();
}

// SS as chip select ends a word half way; as the frame's pulse it begins one.
void Spi::select_edge(void* owner, bool level, Cycle at) {
    Spi& self = *static_cast<Spi*>(owner);
    if (at == kNoCycle || !self.enabled()) return;
    if (self.frame_slave()) {
        if (level != self.pulse_high()) return;
        const bool under_way = self.around_.events.due(self.slot_) != kNoCycle;
        if (self.master() && (!self.state_.shifting || under_way)) return;  // nothing waits for it
        self.state_.framed = true;
        if (self.master()) self.begin(self.state_.shift, at);
        return;
    }
    if (self.master() || self.framed() || !self.uses_select()) return;
    if (level) self.clear_word();
    self.take_word();
    self.drive_bit(at + 1);
}

}  // namespace puckloop::dspic
