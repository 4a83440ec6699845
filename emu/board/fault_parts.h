#pragma once
// What the nodes of boards do alike about their faults. `faults` is null in a node without.

#include "base/archive.h"
#include "cosim/faults/fault_json.h"
#include "emu/chip/faults/analog_faults.h"
#include "emu/chip/faults/board_faults.h"

#include <nlohmann/json_fwd.hpp>

#include <algorithm>
#include <vector>

namespace puckloop::image {
struct AvrImage;
struct Image;
}  // namespace puckloop::image

namespace puckloop::board {

/// Faults of analog inputs, and all others.
struct FaultParts {
    std::vector<cosim::CarriedFault> analog, others;
};
FaultParts fault_parts(const std::vector<cosim::CarriedFault>& faults);

/// Names as in C, with or without the compiler's underscore.
chip::Symbols symbols_of(const image::Image& image);
chip::Symbols symbols_of(const image::AvrImage& image);

/// For "faults" in the node's report.
nlohmann::ordered_json fault_report(const chip::BoardFaults& faults, const chip::AnalogFaults& analog,
                                    cosim::Time end);

/// Runs the chip to `until`; faults that wait for the program act on the way.
template <class Chip>
void run_past_faults(Chip& chip, chip::BoardFaults* faults, cosim::Time until, cosim::Time origin = 0) {
    chip.run_until(until);
    if (faults == nullptr) return;
    while (chip.stopped_at()) {
        faults->arrived(cosim::later(chip.now(), origin));
        chip.run_until(until);
    }
}

/// When something happens that was stamped `time` before the clock's rate may have changed.
template <class Chip>
cosim::Time reached(const Chip& chip, const chip::BoardFaults* faults, cosim::Time time) {
    if (faults == nullptr || !faults->changes_clock()) return time;
    return std::max(time, chip.clock().time_of(chip.cycle()));
}

/// In a saved state; a run with faults can go on from one without, and the other way.
void save_faults(StateWriter& archive, chip::BoardFaults* faults);
void load_faults(StateReader& archive, chip::BoardFaults* faults, cosim::Time now);

}  // namespace puckloop::board
