#pragma once
// Several instruments at one chip.

#include "emu/chip/instrument.h"

#include <vector>

namespace puckloop::debug {

class Instruments final : public chip::Instrument {
  public:
    void add(chip::Instrument& instrument) { all_.push_back(&instrument); }
    bool empty() const { return all_.empty(); }

    /// The first that ends the run keeps the instruction from those behind it.
    bool instruction(std::uint32_t pc, std::uint64_t cycle) override;
    void interrupt(int vector, std::uint32_t pc, std::uint64_t cycle) override;
    void reset(std::uint64_t cycle) override;
    void access(std::uint16_t address, int bytes, bool write) override;

  private:
    std::vector<chip::Instrument*> all_;
};

}  // namespace puckloop::debug
