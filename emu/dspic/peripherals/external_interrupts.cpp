#include "emu/dspic/peripherals/external_interrupts.h"

#include "emu/dspic/devices/dspic30f6014a_irq.h"

namespace puckloop::dspic {

namespace {
constexpr struct {
    PortLetter port;
    int pin;
    std::uint8_t irq;
} kInputs[] = {
    {PortLetter::F, 6, irq::INT0},  {PortLetter::A, 12, irq::INT1}, {PortLetter::A, 13, irq::INT2},
    {PortLetter::A, 14, irq::INT3}, {PortLetter::A, 15, irq::INT4},
};
}  // namespace

ExternalInterrupts::ExternalInterrupts(const Surroundings& around, Ports& ports) : around_(around) {
    for (int i = 0; i < 5; ++i) {
        Input& input = inputs_[static_cast<std::size_t>(i)];
        input = {this, i};
        ports.watch(kInputs[i].port, kInputs[i].pin, &input, pin_changed);
    }
}

void ExternalInterrupts::pin_changed(void* owner, bool level, Cycle at) {
    Input& input = *static_cast<Input*>(owner);
    if (at == kNoCycle) return;
    ExternalInterrupts& self = *input.self;
    if (level == self.around_.interrupts.falling_edge(input.number)) return;
    self.around_.interrupts.raise(kInputs[input.number].irq, at);
    if (input.number == 0 && self.on_int0) self.on_int0(self.on_int0_owner, at);
}

}  // namespace puckloop::dspic
