#pragma once
// PMDx: a bit set takes a module's clock away. It is as after a reset, its registers read 0 and ignore
// writes; cleared, it has to be set up anew. Source: dsPIC30F Family Reference Manual, section 10, and
// DS70286; fact sheet semantics.md section 17.
//
// Deviations
//  1. It happens with the write, not one cycle later.
//  2. The bits of the 33FJ's CAN modules are stored. Pins of a converter that is off stay as ADPCFG
//     has them (silicon: digital).

#include "emu/dspic/layouts/layout.h"
#include "emu/dspic/machine/sfr_space.h"

#include <array>
#include <cstdint>
#include <vector>

namespace puckloop::dspic {

class ModuleDisable {
  public:
    /// `registers`: PMD1, PMD2 and, if the part has it, PMD3 or 0.
    ModuleDisable(SfrSpace& sfr, const Layout& layout, const std::array<std::uint16_t, 3>& registers);

    /// After a reset or a load: who is off follows from the registers.
    void restore();

  private:
    struct Module {
        std::uint16_t pmd = 0;
        std::uint16_t mask = 0;
        std::uint16_t control = 0;             ///< written 0 first
        std::vector<std::uint16_t> registers;  ///< all of them
        bool off = false;
    };
    static void write(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    void add(std::uint16_t pmd, int bit, std::uint16_t control, std::vector<std::uint16_t> registers);
    void switch_off(Module& module);
    void switch_on(Module& module);

    SfrSpace& sfr_;
    std::array<std::uint16_t, 3> registers_;
    std::vector<Module> modules_;
};

}  // namespace puckloop::dspic
