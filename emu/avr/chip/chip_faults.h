#pragma once
// What faults do to an AVR: resets, hangs, another clock, flipped bits, interrupts lost, late and out of
// nowhere.
//
// Deviations
//  1. An interrupt out of nowhere is a request without its flag. It comes to nothing where the source's
//     enable bit is clear.
//  2. A lost interrupt is one that began to request: its flag, which the routine's entry would clear, is
//     clear again. Where the routine itself ends the request (received data, an empty transmit buffer, the
//     two-wire interface) the flag stays, and nothing comes of it until the next event of the source.

#include "emu/avr/chip/chip.h"
#include "emu/chip/faults/image_access.h"
#include "emu/image/avr_image.h"

#include <string>

namespace puckloop::avr {

class ChipFaults : public chip::ImageAccess<Chip, image::AvrImage> {
  public:
    explicit ChipFaults(Chip& chip) : ImageAccess(chip) {}

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

    std::optional<int> vector(std::string_view source) const override;
    bool interrupt(int vector) override;
    void watch_interrupts(std::span<const int> vectors, chip::InterruptTime when) override;

  private:
    image::AvrImage load(const std::string& file, const std::string& sha256) const override;
    static bool passes(void* owner, int vector);

    chip::InterruptTime when_;
};

}  // namespace puckloop::avr
