#include "emu/dspic/peripherals/spi.h"

#include "emu/dspic/devices/register_bits.h"

namespace puckloop::dspic {

namespace {

enum Offset : int { kStat = 0, kCon1 = 2, kCon2 = 4, kBuf = 8 };
constexpr RegisterBits kSPIxSTAT{"SPI?STAT"};
constexpr RegisterBits kSPIxCON1{"SPI?CON1"};
constexpr unsigned kPrimary[] = {64, 16, 4, 1};  // PPRE
constexpr unsigned kSecondaryMost = 8;           // SPRE = 0

}  // namespace

Spi::Spi(const Surroundings& around, const Setup& setup, Ports& ports, Pins& pins)
    : around_(around), setup_(setup), ports_(ports), pins_(pins), slot_(around.events.add(this, due)) {
    const auto at = [&](int offset) { return static_cast<std::uint16_t>(setup_.stat + offset); };
    around_.sfr.hook(at(kStat), this, nullptr, write_stat);
    around_.sfr.hook(at(kCon1), this, nullptr, write_con1);
    around_.sfr.claim(at(kCon2));
    around_.sfr.hook(at(kBuf), this, read_buf, write_buf);
}

void Spi::reset() {
    state_ = {};
    around_.events.cancel(slot_);
}

bool Spi::enabled() const {
    return reg(kStat) & kSPIxSTAT["SPIEN"];
}
bool Spi::master() const {
    return reg(kCon1) & kSPIxCON1["MSTEN"];
}
int Spi::bits() const {
    return reg(kCon1) & kSPIxCON1["MODE16"] ? 16 : 8;
}
Cycle Spi::word_cycles() const {
    const unsigned con1 = reg(kCon1);
    const Cycle clock = kPrimary[kSPIxCON1["PPRE"].of(con1)] * (kSecondaryMost - kSPIxCON1["SPRE"].of(con1));
    return clock * static_cast<Cycle>(bits());
}

void Spi::hold(bool on) {
    if (state_.held == on) return;
    state_.held = on;
    if (!on) return;
    state_.shifting = false;
    around_.events.cancel(slot_);
}

// SCK and SDO rest between words: SCK at its idle level.
void Spi::lend_pins() {
    const std::uint16_t con1 = reg(kCon1);
    const std::uint16_t sck = bit(setup_.sck);
    const std::uint16_t sdo = bit(setup_.sdo);
    const auto all = static_cast<std::uint16_t>(sck | bit(setup_.sdi) | sdo);
    ports_.give_back(setup_.port, all);
    if (!enabled()) return;
    std::uint16_t lent = all;
    if (con1 & kSPIxCON1["DISSCK"]) lent = static_cast<std::uint16_t>(lent & ~sck);
    if (con1 & kSPIxCON1["DISSDO"]) lent = static_cast<std::uint16_t>(lent & ~sdo);
    const auto output = static_cast<std::uint16_t>(lent & ((master() ? sck : 0) | sdo));
    ports_.lend(setup_.port, lent, output, con1 & kSPIxCON1["CKP"] ? sck : 0);
}

void Spi::begin(std::uint16_t value, Cycle from) {
    state_.shifting = true;
    state_.shift = value;
    around_.events.schedule(slot_, from + word_cycles());
}

void Spi::due(void* owner, Cycle due) {
    Spi& self = *static_cast<Spi*>(owner);
    std::uint16_t& stat = self.reg(kStat);
    const int bits = self.bits();
    const std::uint16_t mask = bits == 16 ? 0xFFFF : 0x00FF;
    const auto sent = static_cast<std::uint16_t>(self.state_.shift & mask);
    const auto got =
        static_cast<std::uint16_t>(self.pins_.spi_exchange(self.setup_.unit, sent, bits, due) & mask);
    self.state_.shifting = false;
    if (stat & kSPIxSTAT["SPIRBF"]) {  // nobody fetched the last word: this one is lost
        stat |= kSPIxSTAT["SPIROV"];
        self.around_.interrupts.raise(self.setup_.error_irq, due);
    } else {
        self.state_.received = got;
        stat |= kSPIxSTAT["SPIRBF"];
    }
    if (stat & kSPIxSTAT["SPITBF"]) {
        assign(stat, kSPIxSTAT["SPITBF"], false);
        self.begin(self.state_.waiting, due);
    }
    self.around_.interrupts.raise(self.setup_.irq, due);
}

std::uint16_t Spi::read_buf(void* owner, std::uint16_t) {
    Spi& self = *static_cast<Spi*>(owner);
    assign(self.reg(kStat), kSPIxSTAT["SPIRBF"], false);
    return self.state_.received;
}

void Spi::write_buf(void* owner, std::uint16_t, std::uint16_t value, std::uint16_t mask) {
    Spi& self = *static_cast<Spi*>(owner);
    std::uint16_t& stat = self.reg(kStat);
    if (!self.enabled() || !self.master() || mask == 0xFF00 || self.state_.held) return;
    if (!self.state_.shifting) {
        self.begin(value & mask, self.around_.now + 1);
    } else if (!(stat & kSPIxSTAT["SPITBF"])) {
        self.state_.waiting = value & mask;
        stat |= kSPIxSTAT["SPITBF"];
    }
}

void Spi::write_stat(void* owner, std::uint16_t, std::uint16_t value, std::uint16_t mask) {
    Spi& self = *static_cast<Spi*>(owner);
    std::uint16_t& stat = self.reg(kStat);
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
    self.lend_pins();
}

void Spi::write_con1(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Spi& self = *static_cast<Spi*>(owner);
    self.around_.sfr.store(address, value, mask);
    if (self.enabled()) self.lend_pins();
}

}  // namespace puckloop::dspic
