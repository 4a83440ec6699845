#pragma once
// The Si3000 voice codec as the e-puck has it: a slave on the dsPIC's DCI, RESET at RF0, the speaker behind
// it. Source: Si3000 data sheet (Si3000-DS11): sections on the serial interface and the PLL, control
// registers 1 to 9.
//
// Each frame sync brings a word. Bit 0 of a sample asks for a secondary frame: the next word is a command
// (bit 13 read, bits 12..8 register, bits 7..0 data) and not a sample. Sample rate = MCLK * (M1+1) / ((N1+1)
// * 5 * 1024), with 10 for 5 if PL is set; MCLK is the DCI's bit clock here. A slave's must be that of the
// frame syncs.
//
// Deviations
//  1. Filters are ideal and without delay, the PLL locks at once; where it is more than 2 % beside the frame
//  syncs
//     nothing is converted (silicon: slips).
//  2. The speaker hangs between the two speaker outputs; line and handset outputs lead nowhere on this board.
//  What
//     comes in is the line input, taken for 1 V; there is no microphone and no handset at the codec.
//  3. Commands for other chips of a chain (bits 15, 14) are not heard. Loopbacks DL1, DL2 are stored.
//  4. Words other than 16 bits in slot 0 are not heard.

#include "emu/dspic/peripherals/pins.h"

#include <array>
#include <cstdint>

namespace puckloop::pic {

class Si3000 {
  public:
    Si3000() { reset(); }

    /// RESET: low holds the codec at its power-on registers, silent; the amplifier behind it is off.
    void set_released(bool released);
    bool released() const { return released_; }

    /// A word of the DCI has passed; what the codec sent meanwhile. `line_in`: -1..1 of the ADC's full scale.
    std::uint16_t exchange(const dspic::DciWord& word, double line_in);

    /// What drives the speaker, -1..1 of full scale.
    double speaker() const { return speaker_; }
    /// Is it converting (clocks in step, chip and speaker driver powered)?
    bool sounding() const;
    /// Samples heard while it was.
    std::uint64_t samples() const { return samples_; }
    std::uint8_t reg(int number) const { return registers_.at(static_cast<std::size_t>(number)); }

    static constexpr int kRegisters = 10;  ///< 1..9 exist

    template <class Archive>
    void state(Archive& archive) {
        archive(registers_, released_, secondary_, primary_, period_, samples_);
        archive.bounded(speaker_, -1.0, 1.0);
    }

  private:
    void reset();
    std::uint8_t command(std::uint16_t word);
    bool in_step() const;
    void convert(std::uint16_t word);
    std::uint16_t listen(double line_in) const;

    std::array<std::uint8_t, kRegisters> registers_{};
    bool released_ = false;
    bool secondary_ = false;    ///< the next word is a command
    dspic::Cycle primary_ = 0;  ///< when the last sample began
    std::uint64_t period_ = 0;  ///< bit clocks between the last two samples; 0: unknown
    std::uint64_t samples_ = 0;
    double speaker_ = 0.0;
};

}  // namespace puckloop::pic
