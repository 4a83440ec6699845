#pragma once
// The analog comparator: AIN0 (PB2) or the bandgap against AIN1 (PB3) or an ADC channel. Source: data sheet
// 8272, "Analog Comparator".
//
// Deviations
//  1. The inputs are looked at when the board reports that they changed and when a register is read: the
//  comparator has no
//     hysteresis, and its synchronising delay of 1 to 2 clocks is left out.

#include "emu/avr/peripherals/pins.h"
#include "emu/avr/peripherals/surroundings.h"

namespace puckloop::avr {

class Timer;
class Adc;

class Comparator {
  public:
    Comparator(const Surroundings& around, Pins& pins, Timer& capture, Adc& adc);

    void reset();
    /// An input changed.
    void update();

  private:
    std::uint8_t& control() const { return around_.io.raw(0x50); }
    void update_request();
    static std::uint8_t read_control(void* owner, std::uint16_t address);
    static void write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void acknowledge(void* owner, int vector);

    Surroundings around_;
    Pins& pins_;
    Timer& capture_;
    Adc& adc_;
};

}  // namespace puckloop::avr
