#include "emu/avr/peripherals/external_interrupts.h"

namespace puckloop::avr {

namespace {
constexpr std::uint16_t kPcifr = 0x3B, kEifr = 0x3C, kEimsk = 0x3D, kPcicr = 0x68, kEicra = 0x69;
constexpr std::uint16_t kPcmsk[] = {0x6B, 0x6C, 0x6D, 0x73};
constexpr std::int8_t kInt0 = 1, kPcint0 = 4;
/// ISCn1:0
enum Sense : unsigned { kLowLevel, kAnyChange, kFalling, kRising };
}  // namespace

ExternalInterrupts::ExternalInterrupts(const Surroundings& around, Ports& ports)
    : around_(around),
      ports_(ports),
      edges_(around, {kEifr, kEimsk, {kInt0, kInt0 + 1, kInt0 + 2, -1, -1, -1, -1, -1}}, this, &touched),
      changes_(around, {kPcifr, kPcicr, {kPcint0, kPcint0 + 1, kPcint0 + 2, kPcint0 + 3, -1, -1, -1, -1}}) {
    around_.io.hook(kEicra, this, nullptr, &write_sense);
    for (const std::uint16_t address : kPcmsk)
        around_.io.claim(address);
    ports_.listen(this, &changed);
}

unsigned ExternalInterrupts::sense(int number) const {
    return field(around_.io.raw(kEicra), 2 * number + 1, 2 * number);
}

// A low level requests as long as it lasts; its flag is always cleared.
void ExternalInterrupts::update_levels() {
    for (int i = 0; i < kCount; ++i)
        if (sense(i) == kLowLevel)
            around_.interrupts.request(kInt0 + i, (edges_.masks() & bit(i)) && !ports_.level(kPins[i]));
}

void ExternalInterrupts::touched(void* owner) {
    static_cast<ExternalInterrupts*>(owner)->update_levels();
}

void ExternalInterrupts::write_sense(void* owner, std::uint16_t address, std::uint8_t value,
                                     std::uint8_t mask) {
    auto& self = *static_cast<ExternalInterrupts*>(owner);
    self.around_.io.store(address, value, mask);
    self.edges_.update();
    self.update_levels();
}

void ExternalInterrupts::changed(void* owner, PortLetter port, std::uint8_t before, std::uint8_t after,
                                 Cycle) {
    auto& self = *static_cast<ExternalInterrupts*>(owner);
    const auto difference = static_cast<std::uint8_t>(before ^ after);
    const auto number = static_cast<int>(port);
    if (difference & self.around_.io.raw(kPcmsk[number])) self.changes_.raise(bit(number));
    for (int i = 0; i < kCount; ++i) {
        if (kPins[i].port != port || !(difference & kPins[i].mask())) continue;
        const bool rose = after & kPins[i].mask();
        const unsigned sense = self.sense(i);
        if (sense == kAnyChange || (sense == kRising && rose) || (sense == kFalling && !rose))
            self.edges_.raise(bit(i));
    }
    self.update_levels();
}

}  // namespace puckloop::avr
