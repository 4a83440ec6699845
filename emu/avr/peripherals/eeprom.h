#pragma once
// The data EEPROM behind EEAR, EEDR and EECR. Source: data sheet 8272, "EEPROM Data Memory".
//
// Deviations
//  1. Programming takes the data sheet's typical times, whatever the oscillator and the temperature.

#include "cosim/core/clock.h"
#include "emu/avr/core/core.h"
#include "emu/avr/machine/memory_undo.h"
#include "emu/avr/peripherals/surroundings.h"

#include <cstdint>
#include <vector>

namespace puckloop::avr {

class Eeprom {
  public:
    Eeprom(const Surroundings& around, Core& core, const cosim::ClockDomain& clock, std::size_t bytes);

    void reset();
    /// Before and after a change of the CPU's clock, which does not time the programming.
    void rate_changes(bool changed);
    std::vector<std::uint8_t>& bytes() { return bytes_; }
    /// Another byte in a cell, by no programming.
    void poke(std::size_t cell, std::uint8_t byte) {
        undo_.note(static_cast<std::uint32_t>(cell), bytes_[cell]);
        bytes_[cell] = byte;
    }
    bool busy() const { return around_.now < state_.busy_until; }

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
        if constexpr (!Archive::kRaw) archive.fixed(bytes_);  // see mark()
    }

    /// As Core::mark(), rewind() and settle().
    void mark() { undo_.begin(); }
    void rewind() {
        undo_.rewind([this](std::uint32_t cell, std::uint8_t byte) { bytes_[cell] = byte; });
    }
    void settle() { undo_.end(); }

  private:
    struct State {
        Cycle armed_until = 0;  ///< EEMPE is set up to here
        Cycle busy_until = 0;   ///< EEPE

        template <class Archive>
        void state(Archive& archive) {
            archive(armed_until, busy_until);
        }
    };
    std::size_t address() const;
    void program();
    void update_request(Cycle now);
    static std::uint8_t read_control(void* owner, std::uint16_t address);
    static void write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void due(void* owner, Cycle cycle);

    Surroundings around_;
    Core& core_;
    const cosim::ClockDomain& clock_;
    std::vector<std::uint8_t> bytes_;
    MemoryUndo<std::uint8_t> undo_;
    State state_;
    cosim::Time kept_ = 0;  ///< when the event is due, while the clock's rate changes
    EventQueue::Slot slot_;
};

}  // namespace puckloop::avr
