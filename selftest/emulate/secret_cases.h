#pragma once
// The self test on the emulator: a robot changed in secret, recorded with the firmware in the loop, analysed
// against the unchanged model.

#include "gap/verdict/verdict.h"
#include "selftest/emulate/record.h"
#include "selftest/emulate/secrets.h"

#include <string>
#include <vector>

namespace puckloop::gap::emulate {

struct SecretResult {
    const Secret* secret = nullptr;
    std::string changed;             ///< what was set, with its numbers
    std::string decision, error;     ///< error: the recording or the analysis failed
    std::vector<std::string> named;  ///< causes, the first one first
    std::vector<std::string> told;   ///< the causes' parameters with intervals
    bool found = false;              ///< the first cause is a right one; of nothing changed: no effect
    Rerun again;                     ///< where a cause was named: with its overlay, beside the true robot
};

/// Records and analyses case `number`, drawn with the options' seed, or as the closed loop has it: typed
/// values, the tracker's pose of one moment, as many rays as the fitted model. Folders are made in
/// `options.scratch` and, unless they are kept, removed.
SecretResult try_secret(std::size_t number, bool closed_loop, const RecordOptions& options);

/// Performs a measured experiment again with the overlay of its verdict, beside the simulator as it is and
/// the true robot (`recorded.robot`), whose own differences are the floor.
/// `by_time`: what was changed in it depends on the time.
Rerun performed_again(const Experiment& measured, const Verdict& verdict, const RecordOptions& recorded,
                      bool by_time = false);
/// Were observables beyond the true robot's floor as the simulator is, and is none of them with the overlay?
bool is_back(const Rerun& again);
/// Was something performed, and none beyond the floor without the overlay and with it?
bool shows_nothing(const Rerun& again);
/// Errors before, after and of the true robot, in two lines.
std::string again_text(const Rerun& again);

/// What was changed and what was said, with the first parameters; ends with a line feed.
std::string secret_line(const SecretResult& result);
/// A table for people.
std::string secrets_text(const std::vector<SecretResult>& results);

}  // namespace puckloop::gap::emulate
