#pragma once
// What the nodes of boards do alike about their faults. `faults` is null in a node without.

#include "base/states/archive.h"
#include "cosim/faults/fault_json.h"
#include "emu/chip/faults/analog_faults.h"
#include "emu/chip/faults/board_faults.h"

#include <nlohmann/json_fwd.hpp>

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

namespace puckloop::image {
struct AvrImage;
struct Image;
}  // namespace puckloop::image

namespace puckloop::board {

/// Names as in C, with or without the compiler's underscore.
chip::Symbols symbols_of(const image::Image& image);
chip::Symbols symbols_of(const image::AvrImage& image);

/// Where a board's faults act, and by which clock: its cycles begin at `origin` in the run's time, off by
/// `ppm`.
struct FaultSites {
    chip::ChipAccess& chip;
    chip::BoardAccess& board;
    chip::AnalogFaults& analog;
    const cosim::ClockDomain& clock;
    double ppm = 0;
    cosim::Time origin = 0;
};
/// Gives those of analog inputs to `sites.analog`; the result has all others.
std::unique_ptr<chip::BoardFaults> make_faults(const std::vector<cosim::CarriedFault>& faults,
                                               const FaultSites& sites, const chip::Symbols& symbols);

/// Carries out what is due before `until` (and at it, if inclusive), the board being run to each by
/// `run_until`.
void act_until(chip::BoardFaults* faults, cosim::Time until, bool inclusive, auto run_until) {
    while (faults != nullptr && faults->due(until, inclusive)) {
        const cosim::Time time = faults->next();
        run_until(time);
        faults->act(time);
    }
}

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
    if (faults == nullptr || !faults->clock_changed(time)) return time;
    return std::max(time, chip.clock().time_of(chip.cycle()));
}

/// In a saved state; a run with faults can go on from one without, and the other way: what faults of the
/// saved run did to the board's parts ends then, what they did to its chip (memory, registers, the clock's
/// rate) stays.
void save_faults(StateWriter& archive, const chip::BoardFaults* faults);
/// The board's faults go on from what save_faults() wrote, at `now`. `make_none` makes faults for a board
/// that has none (a list without any): what the saved run's did ends with them, once the board runs.
void load_faults(StateReader& archive, std::unique_ptr<chip::BoardFaults>& faults, cosim::Time now,
                 const std::function<std::unique_ptr<chip::BoardFaults>()>& make_none);

}  // namespace puckloop::board
