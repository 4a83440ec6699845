#pragma once
// The TLC59116: sixteen LED outputs behind 32 registers on the two-wire bus.
// Source: data sheet SLDS157; addresses and use: TAM fact sheet, section 5.
//
// Deviations:
// 1. An output is known by the share of the time that it is on; the pulses of the 97 kHz brightness and of
//    the group brightness (190 Hz) are not followed. Group blinking counts as its duty.
// 2. The oscillator starts at once (data sheet: at most 500 us after SLEEP is cleared).
// 3. LEDs do not fail: EFLAG1 and EFLAG2 read 0. Sub-addresses are not listened to.

#include "emu/tam_avr/signals.h"

#include <array>
#include <cstdint>

namespace puckloop::tam {

class LedDriver {
  public:
    static constexpr std::uint8_t kAddress = 0x60;  ///< A3..A0 low
    static constexpr std::uint8_t kAllCallAddress = 0x68, kSoftwareResetAddress = 0x6B;

    LedDriver() { reset(); }
    /// As after power-on or a low level at RESET.
    void reset();

    /// START with an address byte: true if acknowledged.
    bool start(std::uint8_t address_byte);
    /// A byte for the addressed driver: true if acknowledged.
    bool write(std::uint8_t byte);
    std::uint8_t read();
    /// STOP, or a repeated START: outputs follow the registers. Returns those that changed, bit 0 = output 0.
    std::uint16_t stop();
    std::uint64_t registers_written() const { return writes_; }

    /// Share of the time that output `led` is on, 0..1, as of the last STOP.
    double duty(int led) const { return duties_[static_cast<std::size_t>(led)]; }
    std::uint8_t register_value(int number) const { return registers_[static_cast<std::size_t>(number)]; }

    template <class Archive>
    void state(Archive& archive) {
        archive(registers_, control_, control_next_, reset_, reset_step_, writes_);
        for (double& duty : duties_)
            archive.bounded(duty, 0.0, 1.0);
    }

  private:
    static constexpr int kRegisters = 0x1F;

    double duty_of(int led) const;
    void advance_register();

    std::array<std::uint8_t, kRegisters> registers_{};
    std::array<double, kLeds> duties_{};
    std::uint8_t control_ = 0;     ///< auto-increment flags and register number
    bool control_next_ = false;    ///< the next byte written is the control byte
    bool reset_ = false;           ///< addressed for a software reset
    std::uint8_t reset_step_ = 0;  ///< bytes of it seen
    std::uint64_t writes_ = 0;     ///< registers written
};

}  // namespace puckloop::tam
