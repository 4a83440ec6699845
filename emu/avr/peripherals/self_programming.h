#pragma once
// SPM from the boot section: page buffer, page erase and write, the busy read-while-write section, lock bits,
// and fuses and signature read through LPM. Source: data sheet 8272, "Boot Loader Support".
//
// Deviations
//  1. Erasing and writing a page take 3.7 ms, the data sheet's minimum.
//  2. A byte that boot lock bits keep from being read is 0xFF, a page that they protect stays as it is: the
//     data sheet only states that it is not allowed.

#include "cosim/core/clock.h"
#include "emu/avr/core/core.h"
#include "emu/avr/devices/fuses.h"
#include "emu/avr/peripherals/system_control.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace puckloop::avr {

class SelfProgramming {
  public:
    SelfProgramming(const Surroundings& around, Core& core, const cosim::ClockDomain& clock, Fuses& fuses,
                    const SystemControl& system);

    void reset();
    /// Before and after a change of the CPU's clock, which does not time the programming.
    void rate_changes(bool changed);
    /// SPM with Z (RAMPZ in front) and R1:R0. Returns why it does nothing, or an empty text.
    std::string_view spm(std::uint32_t address, std::uint16_t word);
    /// Lock bits keep interrupts off here: their vectors are in a section that may not be read from the one
    /// in which the program runs (tables 25-2 and 25-3, modes 3 and 4).
    bool interrupts_locked() const;
    /// LPM: true and a value where the flash does not answer.
    bool load(std::uint32_t address, std::uint8_t& value) const;

    template <class Archive>
    void state(Archive& archive) {
        archive(armed_until_, busy_);
        archive.fixed(buffer_);
    }

  private:
    std::uint8_t& control() const { return around_.io.raw(0x57); }
    bool in_rww(std::uint32_t word) const;
    bool writable(std::uint32_t word) const;
    bool readable(std::uint32_t word) const;
    void begin(std::uint32_t word);
    void update_request();
    static std::uint8_t read_control(void* owner, std::uint16_t address);
    static void write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void due(void* owner, Cycle cycle);

    Surroundings around_;
    Core& core_;
    const cosim::ClockDomain& clock_;
    Fuses& fuses_;
    const SystemControl& system_;
    std::vector<std::uint16_t> buffer_;
    Cycle armed_until_ = 0;
    bool busy_ = false;
    cosim::Time kept_ = 0;  ///< when the event is due, while the clock's rate changes
    EventQueue::Slot slot_;
};

}  // namespace puckloop::avr
