#pragma once
// A dsPIC chip beside firmware that runs on the host. Source of the instruction words: isa.

#include "emu/dspic/chip/chip.h"
#include "firmware/host/host.h"
#include "firmware/host/vector.h"

#include <span>
#include <string>
#include <vector>

namespace hosted {

class DspicHost : public Host {
  public:
    /// Configuration words are those of the image in `image_file`.
    DspicHost(const puckloop::dspic::DeviceInfo& device, puckloop::dspic::Pins& pins,
              const puckloop::dspic::ChipOptions& options, const std::string& image_file,
              std::span<const Vector> vectors);

    std::uint16_t read_word(std::uint16_t address) override;
    void write_word(std::uint16_t address, std::uint16_t value) override;
    std::uint8_t read_byte(std::uint16_t address) override;
    void write_byte(std::uint16_t address, std::uint8_t value) override;
    void idle() override;
    void no_interrupts(unsigned cycles);
    /// What stands behind `__asm__ volatile(`, as the preprocessor quotes it: assembled, and executed by the
    /// chip's core.
    void assembly(const std::string& text);
    Cycle cycle() const override { return chip_.cycle(); }
    puckloop::cosim::Time time() const { return chip_.clock().time_of(cycle()); }
    puckloop::dspic::Chip& chip() { return chip_; }

  protected:
    void run_to(Cycle end) override;
    /// Cycles in so many microseconds, by the chip's present rate.
    Cycle cycles(double microseconds) const;

  private:
    void serve(std::uint32_t stop);
    void run_one(std::uint32_t pc);

    puckloop::dspic::Chip chip_;
    std::vector<void (*)()> routines_;
};

}  // namespace hosted
