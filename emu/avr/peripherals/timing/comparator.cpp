#include "emu/avr/peripherals/timing/comparator.h"

#include "emu/avr/peripherals/shared_registers.h"

#include "emu/avr/peripherals/adc.h"
#include "emu/avr/peripherals/timing/timer.h"

namespace puckloop::avr {

namespace {
constexpr int kComparatorVector = 23;
constexpr std::uint16_t kAcsr = 0x50;
constexpr std::uint8_t kAcd = bit(7), kAcbg = bit(6), kAco = bit(5), kAci = bit(4), kAcie = bit(3),
                       kAcic = bit(2);
constexpr std::uint8_t kAcme = bit(6);
constexpr unsigned kOutputToggle = 0, kOutputFalling = 2, kOutputRising = 3;  // ACIS1:0
constexpr unsigned kAdcTrigger = 1;
}  // namespace

Comparator::Comparator(const Surroundings& around, Pins& pins, Timer& capture, Adc& adc)
    : around_(around), pins_(pins), capture_(capture), adc_(adc) {
    around_.io.hook(kAcsr, this, &read_control, &write_control);
    around_.interrupts.connect(kComparatorVector, this, &acknowledge);
}

void Comparator::reset() {
    control() = 0;
    capture_.use_comparator(false);
}

void Comparator::update_request() {
    around_.interrupts.request(kComparatorVector, (control() & kAci) && (control() & kAcie));
}
void Comparator::acknowledge(void* owner, int) {
    auto& self = *static_cast<Comparator*>(owner);
    assign(self.control(), kAci, false);
    self.update_request();
}

void Comparator::update() {
    if (control() & kAcd) return;
    const bool multiplexed = (around_.io.raw(kAdcsrb) & kAcme) && !(around_.io.raw(kAdcsra) & kAden);
    const int channel = static_cast<int>(field(around_.io.raw(kAdmux), 2, 0));
    const double positive = control() & kAcbg ? kBandgap : pins_.comparator(false, around_.now);
    const double negative =
        multiplexed ? pins_.analog(channel, around_.now) : pins_.comparator(true, around_.now);
    const bool output = positive > negative;
    if (output == static_cast<bool>(control() & kAco)) return;
    assign(control(), kAco, output);
    const unsigned select = field(control(), 1, 0);
    if (select == kOutputToggle || (select == kOutputRising && output) ||
        (select == kOutputFalling && !output)) {
        control() |= kAci;
        update_request();
        adc_.trigger(kAdcTrigger);
    }
    if (control() & kAcic) capture_.capture_edge(output);
}

std::uint8_t Comparator::read_control(void* owner, std::uint16_t) {
    auto& self = *static_cast<Comparator*>(owner);
    self.update();
    return self.control();
}

void Comparator::write_control(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Comparator*>(owner);
    self.control() = merged(self.control(), value, mask & static_cast<std::uint8_t>(~(kAco | kAci)));
    if (value & mask & kAci) assign(self.control(), kAci, false);
    self.capture_.use_comparator(self.control() & kAcic);
    self.update();
    self.update_request();
}

}  // namespace puckloop::avr
