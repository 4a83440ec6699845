#pragma once
// What faults do to an AVR: resets, hangs, another clock, flipped bits.
//
// Deviations
//  1. No interrupt out of nowhere: a source requests as long as its flag and its enable bit are set; flip the
//     flag's bit.

#include "emu/avr/chip.h"
#include "emu/chip/faults/chip_access.h"

namespace puckloop::avr {

class ChipFaults : public chip::ChipAccess {
  public:
    explicit ChipFaults(Chip& chip) : chip_(chip) {}

    std::uint32_t pc() const override { return chip_.pc(); }
    bool stopped() const override { return chip_.stopped_at().has_value(); }
    void set_stops(std::span<const std::uint32_t> addresses) override;

    bool knows(chip::FaultReset cause) const override;
    void reset(chip::FaultReset cause) override;
    void hang(cosim::Time until) override;
    void set_ppm(double ppm) override;

    std::uint32_t cells(chip::MemorySpace space) const override;
    chip::MemoryPlace cell(chip::MemorySpace space, std::uint32_t i) const override;
    /// "R0".."R31" and every register of the device's table.
    std::optional<chip::MemoryPlace> find_register(std::string_view name) const override;
    std::uint32_t bits(const chip::MemoryPlace& place) const override;
    std::uint32_t read(const chip::MemoryPlace& place) const override;
    void flip(const chip::MemoryPlace& place, std::uint32_t mask) override;
    std::string_view name(const chip::MemoryPlace& place) const override;

    std::optional<int> vector(std::string_view) const override { return std::nullopt; }
    void interrupt(int) override {}

  private:
    Chip& chip_;
};

}  // namespace puckloop::avr
