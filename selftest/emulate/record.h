#pragma once
// An experiment recorded on the emulator, as the folder a laboratory would hand over (docs/gap.md).

#include "gap/data/written.h"
#include "selftest/emulate/plans.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace puckloop::gap::emulate {

struct RecordOptions {
    Robot robot;
    Tools tools;
    std::uint64_t seed = 1;
    bool brief = false;
    bool keep = false;                                   ///< of a secret's trial: leave its folders
    std::filesystem::path scratch;                       ///< for the runs' own results
    std::function<void(std::size_t, std::size_t)> done;  ///< runs done, of all
};

/// Performs the acts of a kind and lists what was measured, with a tracker's or jig's noise on the truth.
WrittenExperiment record(std::string_view kind, const RecordOptions& options);

/// "robot.axle_length=0.054": a physical parameter, or one of the boards, the line between them (uart.*) and
/// the Linux program (linux.*, host.*; s). Throws InputError, which names them all.
void set_parameter(Robot& robot, const std::string& assignment);

/// The kinds of recordings whose rows hold what this parameter of set_parameter() does: by the catalogue's
/// effects that enter the simulator there, by the sensor that it belongs to. Empty: it is not known.
std::vector<std::string> kinds_showing(std::string_view name);

}  // namespace puckloop::gap::emulate
