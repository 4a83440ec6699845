#pragma once
// INT0 to INT4: an edge on the pin, rising or falling by INTCON2<INTnEP>, sets INTnIF.
// Source: dsPIC30F Family Reference Manual, section 6; pin map of the 80-pin and
// 100-pin parts.

#include "emu/dspic/peripherals/ports.h"

#include <array>

namespace puckloop::dspic {

class ExternalInterrupts {
  public:
    /// `irqs`: request numbers of INT0 to INT4.
    ExternalInterrupts(const Surroundings& around, Ports& ports, const std::array<std::uint8_t, 5>& irqs);

    /// Called at each active edge of INT0 (it can start A/D conversions); may stay empty.
    void (*on_int0)(void* owner, Cycle at) = nullptr;
    void* on_int0_owner = nullptr;

  private:
    struct Input {
        ExternalInterrupts* self = nullptr;
        int number = 0;
    };
    static void pin_changed(void* owner, bool level, Cycle at);

    Surroundings around_;
    std::array<std::uint8_t, 5> irqs_;
    std::array<Input, 5> inputs_{};
};

}  // namespace puckloop::dspic
