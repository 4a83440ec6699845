#pragma once
// What faults do to a dsPIC: resets, hangs, another clock, flipped bits, interrupts out of nowhere.

#include "emu/chip/faults/image_access.h"
#include "emu/dspic/chip/chip.h"
#include "emu/image/image.h"

#include <string>

namespace puckloop::dspic {

class ChipFaults : public chip::ImageAccess<Chip, image::Image> {
  public:
    explicit ChipFaults(Chip& chip) : ImageAccess(chip) {}

    std::uint32_t pc() const override { return chip_.pc(); }
    bool stopped() const override { return chip_.stopped_at().has_value(); }
    void set_stops(std::span<const std::uint32_t> addresses) override;

    bool knows(chip::FaultReset) const override { return true; }
    void reset(chip::FaultReset cause) override;
    void hang(cosim::Time until) override;
    void set_ppm(double ppm) override;

    std::uint32_t cells(chip::MemorySpace space) const override;
    chip::MemoryPlace cell(chip::MemorySpace space, std::uint32_t i) const override;
    /// "W0".."W15" and every modelled register of the device's table.
    std::optional<chip::MemoryPlace> find_register(std::string_view name) const override;
    std::uint32_t bits(const chip::MemoryPlace& place) const override;
    std::uint32_t read(const chip::MemoryPlace& place) const override;
    void flip(const chip::MemoryPlace& place, std::uint32_t mask) override;
    std::string_view name(const chip::MemoryPlace& place) const override;

    std::optional<int> vector(std::string_view source) const override;
    bool interrupt(int vector) override;
    void watch_interrupts(std::span<const int> vectors, chip::InterruptTime when) override;

  private:
    image::Image load(const std::string& file, const std::string& sha256) const override;
    static bool passes(void* owner, int irq, Cycle now);
    void flip_register(std::uint16_t address, std::uint16_t mask);

    chip::InterruptTime when_;
};

}  // namespace puckloop::dspic
