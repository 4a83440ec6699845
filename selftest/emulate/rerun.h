#pragma once
// The end of the way: the measured experiment is performed again on the emulator, first as the simulator is,
// then with the verdict's overlay, and both are compared with what was measured.
//
// Kinds: motion (commands recorded), timing, ground (greys), proximity (a flat wall), microphone (a
// loudspeaker), accelerometer (tilts), range and bearing (rerun_rab.h). Placements of sensors are re-made
// standing, a selection of them where there are many.

#include "gap/pipeline/analyse.h"
#include "selftest/emulate/stage.h"

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
    bool by_time = false;  ///< standing robots stand until a row was measured, whatever was learnt
    std::optional<Robot>
        truth;  ///< the robot that was recorded, for the floor: performed kTruePerformances times
    std::function<void(std::size_t, std::size_t)> done;  ///< runs done, of all
};

/// As many performances of the true robot make the floor: of one alone chance may be anything.
inline constexpr std::size_t kTruePerformances = 4;
/// Performances in order: the simulator as it is, with the overlay, then those of the true robot.
inline constexpr std::size_t kOverlaySide = 1, kTrueSide = 2;
/// s between two polls of a host: of the program beside the boards, which an overlay cannot set.
inline constexpr const char* kFetchTime = "rab.fetch_time";

/// Of each observable the errors of the simulator as it is, with the overlay, and of the true robot.
RerunObservable observable_of(const std::string& name, const std::string& unit,
                              const std::vector<double>& errors);
/// Seeds of the performances; two without a true robot.
std::vector<std::uint64_t> seeds_of(const RerunOptions& options);

/// Never throws for an experiment that cannot be performed: `not_done` says why.
Rerun rerun(const Experiment& experiment, const Verdict& verdict, const RerunOptions& options);

}  // namespace puckloop::gap::emulate
