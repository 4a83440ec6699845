#pragma once
// What has to be done on the emulator to perform a measured experiment again, and what is compared then.

#include "gap/data/experiment.h"
#include "tools/gap/emulate/stage.h"

#include <string>
#include <utility>
#include <vector>

namespace puckloop::gap::emulate {

/// Squared errors of one observable.
struct ErrorSum {
    double squares = 0.0;
    std::size_t rows = 0;
};

/// One run of the emulator with the measured rows that it stands for.
struct React {
    Act act;
    double period = 0.1;               ///< s between two exchanges
    std::size_t run = 0;               ///< of the experiment
    std::vector<std::size_t> rows{};   ///< of the run; of placements: run and row in turn
    std::size_t sensor = 0;            ///< proximity, microphone: which sensor it is about
    double x = 0, y = 0, heading = 0;  ///< motion: measured pose that the act's start stands for
};

/// Empty with `why` said: this experiment cannot be performed. Where the robot only stands it does so until
/// the row was measured, but for no more than `longest` seconds (1 at least).
std::vector<React> reacts_of(const Experiment& experiment, double longest, std::string& why);

/// `most` of them at even spaces, all if there are no more.
std::vector<React> spread_of(const std::vector<React>& all, std::size_t most);

/// Names and units of what is compared, in the order of ErrorSums.
std::vector<std::pair<const char*, const char*>> compared(Kind kind);

/// Adds the errors of `emulated` against the rows measured.
void add_errors(const Experiment& experiment, const React& react, const std::vector<Row>& emulated,
                std::vector<ErrorSum>& errors);

}  // namespace puckloop::gap::emulate
