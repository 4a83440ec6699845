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

/// What was changed and what was said, with the first parameters; ends with a line feed.
std::string secret_line(const SecretResult& result);
/// A table for people.
std::string secrets_text(const std::vector<SecretResult>& results);

}  // namespace puckloop::gap::emulate
