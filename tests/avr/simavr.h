#pragma once
// simavr's core as a second opinion, driven one instruction at a time. Debian's libsimavr is GPL 3; it is
// linked into tests only, never into the product.

#include "emu/avr/machine/state.h"

#include <cstdint>
#include <memory>

struct avr_t;

namespace puckloop::avr::test {

class Simavr {
  public:
    Simavr();
    ~Simavr();

    void set_program(std::uint32_t word_address, std::uint16_t word);
    void set_data(std::uint16_t address, std::uint8_t value);
    std::uint8_t data(std::uint16_t address) const;
    void set_state(const CoreState& state);
    CoreState state() const;
    /// One instruction.
    void step();
    /// With timers and interrupts, until the PC is at a byte address; gives up after 400 million cycles.
    void run_to(std::uint32_t address);

  private:
    struct Free {
        void operator()(avr_t* chip) const;
    };
    std::unique_ptr<avr_t, Free> chip_;
};

}  // namespace puckloop::avr::test
