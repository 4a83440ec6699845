#include "emu/dspic/peripherals/external_interrupts.h"

namespace puckloop::dspic {

namespace {
constexpr Ports::Pin kIntPins[] = {
    {PortLetter::F, 6}, {PortLetter::A, 12}, {PortLetter::A, 13}, {PortLetter::A, 14}, {PortLetter::A, 15},
};
}  // namespace

ExternalInterrupts::ExternalInterrupts(const Surroundings& around, Ports& ports,
                                       const std::array<std::uint8_t, 5>& irqs)
    : around_(around), irqs_(irqs) {
    for (int i = 0; i < 5; ++i) {
        Input& input = inputs_[static_cast<std::size_t>(i)];
        input = {this, i};
        ports.watch(kIntPins[i].port, kIntPins[i].number, &input, pin_changed);
    }
}

void ExternalInterrupts::pin_changed(void* owner, bool level, Cycle at) {
    Input& input = *static_cast<Input*>(owner);
    if (at == kNoCycle) return;
    ExternalInterrupts& self = *input.self;
    if (level == self.around_.interrupts.falling_edge(input.number)) return;
    self.around_.interrupts.raise(self.irqs_[static_cast<std::size_t>(input.number)], at);
    if (input.number == 0 && self.on_int0) self.on_int0(self.on_int0_owner, at);
}

}  // namespace puckloop::dspic
