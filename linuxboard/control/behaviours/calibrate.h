#pragma once
// Measures a board's gain: this robot stands still, another one sends from 20 cm away.

#include "linuxboard/control/rab/rab_board.h"
#include "linuxboard/control/rab/rab_range.h"

#include <functional>

namespace puckloop::control {

struct CalibrationSettings {
    int messages = 100;
    int own_id = 0;
    double poll_period = 0.020;  ///< s
    double duration = 60;        ///< s to wait for all messages, 0: until interrupted
};

/// Polls a board that is set up until the messages are there, the time is over, or `interrupted`.
RangeCalibration calibrate_range(RabBoard& board, Clock& clock, const std::function<bool()>& interrupted,
                                 const CalibrationSettings& settings);

}  // namespace puckloop::control
