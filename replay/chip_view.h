#pragma once
// What a node of a run has for a chip: registers and variables by name, and its clock.

#include "cosim/core/clock.h"
#include "cosim/core/node.h"
#include "emu/chip/faults/chip_access.h"
#include "run/description/node_description.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace puckloop::tools {

struct Variable {
    std::uint32_t address = 0;  ///< data address
    std::uint32_t size = 0;     ///< bytes; 0: the firmware's file does not say
};

struct ChipView {
    std::unique_ptr<chip::ChipAccess> chip;
    const cosim::ClockDomain* clock = nullptr;  ///< instruction cycles
    cosim::Time origin = 0;                     ///< of the chip's time in the run's
    cosim::Time lives_from = 0;                 ///< the time of its saved state, if it begins with one
    std::uint32_t cell_bytes = 2;               ///< of a register or a cell of RAM
    std::string_view name;                      ///< of the chip
    std::map<std::string, Variable> variables;  ///< of the firmware
};

/// `node` was made from `spec`, and both stay. Throws InputError: it has no chip, or its image cannot be read
/// any more.
ChipView view_of(const NodeDescription& spec, cosim::Node& node);

}  // namespace puckloop::tools
