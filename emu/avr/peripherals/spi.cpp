#include "emu/avr/peripherals/spi.h"

namespace puckloop::avr {

namespace {
constexpr int kVector = 19;
constexpr std::uint16_t kSpcr = 0x4C, kSpsr = 0x4D, kSpdr = 0x4E;
constexpr std::uint8_t kSpie = bit(7), kSpe = bit(6), kMstr = bit(4);    // SPCR
constexpr std::uint8_t kSpif = bit(7), kWcol = bit(6), kSpi2x = bit(0);  // SPSR
constexpr Cycle kDividers[] = {4, 16, 64, 128};                          // SPR1:0
constexpr Cycle kBits = 8;
}  // namespace

Spi::Spi(const Surroundings& around, Pins& pins)
    : around_(around), pins_(pins), slot_(around.events.add(this, &due)) {
    around_.io.hook(kSpcr, this, nullptr, &write_control);
    around_.io.hook(kSpsr, this, &read_status, &write_status);
    around_.io.hook(kSpdr, this, &read_data, &write_data);
    around_.interrupts.connect(kVector, this, &acknowledge);
}

void Spi::reset() {
    shifting_ = status_read_ = false;
    received_ = sent_ = 0;
    around_.events.cancel(slot_);
}

void Spi::update_request() {
    around_.interrupts.request(kVector, (status() & kSpif) && (control() & kSpie));
}
void Spi::acknowledge(void* owner, int) {
    auto& self = *static_cast<Spi*>(owner);
    assign(self.status(), kSpif, false);
    self.update_request();
}

void Spi::complete(std::uint8_t received) {
    shifting_ = false;
    received_ = received;
    status() |= kSpif;
    update_request();
}

void Spi::due(void* owner, Cycle cycle) {
    auto& self = *static_cast<Spi*>(owner);
    self.complete(self.pins_.spi_exchange(self.sent_, cycle));
}

std::uint8_t Spi::slave_exchange(std::uint8_t received) {
    if (!(control() & kSpe) || (control() & kMstr)) return 0xFF;
    const std::uint8_t out = sent_;
    sent_ = received;  // the shift register now holds it
    complete(received);
    return out;
}

std::uint8_t Spi::read_status(void* owner, std::uint16_t) {
    auto& self = *static_cast<Spi*>(owner);
    self.status_read_ = self.status() & (kSpif | kWcol);
    return self.status();
}
void Spi::write_status(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Spi*>(owner);
    self.status() = merged(self.status(), value, mask & kSpi2x);
}
void Spi::write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Spi*>(owner);
    self.around_.io.store(address, value, mask);
    self.update_request();
}

std::uint8_t Spi::read_data(void* owner, std::uint16_t) {
    auto& self = *static_cast<Spi*>(owner);
    if (self.status_read_) {
        self.status_read_ = false;
        self.status() &= static_cast<std::uint8_t>(~(kSpif | kWcol));
        self.update_request();
    }
    return self.received_;
}

void Spi::write_data(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t) {
    auto& self = *static_cast<Spi*>(owner);
    read_data(owner, kSpdr);
    if (self.shifting_) {
        self.status() |= kWcol;
        return;
    }
    self.sent_ = value;
    if (!(self.control() & kSpe) || !(self.control() & kMstr)) return;
    self.shifting_ = true;
    Cycle divider = kDividers[field(self.control(), 1, 0)];
    if (self.status() & kSpi2x) divider /= 2;
    self.around_.events.schedule(self.slot_, self.around_.now + 1 + kBits * divider);
}

}  // namespace puckloop::avr
