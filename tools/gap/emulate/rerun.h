#pragma once
// The end of the way: the measured experiment is performed again on the emulator, first as the simulator is,
// then with the verdict's overlay, and both are compared with what was measured.
//
// Kinds: motion (commands recorded), timing, ground (greys), proximity (a flat wall), microphone (a
// loudspeaker), accelerometer (tilts), range and bearing (rerun_rab.h). Placements of sensors are re-made
// standing, a selection of them where there are many.

#include "gap/pipeline/analyse.h"
#include "tools/gap/emulate/stage.h"

#include <filesystem>
#include <functional>
#include <optional>

namespace puckloop::gap::emulate {

struct RerunOptions {
    Tools tools;
    std::filesystem::path overlay;   ///< overlay.toml of the verdict
    std::filesystem::path firmware;  ///< of the main board; empty: the project's own
    std::filesystem::path scratch;   ///< made, and removed
    std::uint64_t seed = 1;
    double longest = 0.0;  ///< s of simulated time for each of the two: runs from all over are chosen; 0: all
    std::optional<Robot> truth;  ///< the robot that was recorded, for the floor: performed as a third
    std::function<void(std::size_t, std::size_t)> done;  ///< runs done, of all
};

/// Never throws for an experiment that cannot be performed: `not_done` says why.
Rerun rerun(const Experiment& experiment, const Verdict& verdict, const RerunOptions& options);

}  // namespace puckloop::gap::emulate
