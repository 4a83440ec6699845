#pragma once
// What has to be done on the emulator to perform a measured experiment again, and what is compared then.

#include "gap/data/experiment.h"
#include "selftest/emulate/comparison.h"
#include "selftest/emulate/record_serial.h"
#include "selftest/emulate/stage.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::gap::emulate {

/// One run of the emulator with the measured rows that it stands for.
struct React {
    Act act;
    double period = 0.1;               ///< s between two exchanges
    std::size_t run = 0;               ///< of the experiment
    std::vector<std::size_t> rows{};   ///< of the run; of placements: run and row in turn
    std::size_t sensor = 0;            ///< proximity, microphone: which sensor it is about
    bool line = false;                 ///< timing: about the bytes on the main board's line
    bool timed = false;                ///< microphone, accelerometer: a row is looked at about its own time
    double x = 0, y = 0, heading = 0;  ///< motion: measured pose that the act's start stands for
};

/// Empty with `why` said: this experiment cannot be performed. Where the robot only stands it does so until
/// the row was measured, but for no more than `longest` seconds (1 at least).
std::vector<React> reacts_of(const Experiment& experiment, double longest, std::string& why);

/// `most` of them at even spaces, all if there are no more.
std::vector<React> spread_of(const std::vector<React>& all, std::size_t most);

/// What a standing robot's sensor read about the time `t` since power came, or nearest to it.
std::vector<double> standing(const std::vector<Row>& emulated, double t,
                             const std::function<double(const Row&)>& value);

/// What one performance gave.
struct Performed {
    std::vector<Row> rows;
    std::vector<SerialAnswer> answers;  ///< of a React about the line
};

/// Names and units of what is compared, in the order of Comparisons: what is compared row by row, then the
/// distributions of what chance puts elsewhere each time.
std::vector<std::pair<const char*, const char*>> compared(const Kind& kind);

/// Adds what was measured and what was performed. `plain`: the simulator as it is, which distributions are
/// taken about.
void compare(const Experiment& experiment, const React& react, const Performed& performed,
             const Performed& plain, std::vector<Comparison>& comparisons);

}  // namespace puckloop::gap::emulate
