#pragma once
// Ears and radio of Couceiro et al. (Robotics and Autonomous Systems 62, 2014; fig. 11) with the radio: in a
// field of 60 x 60 cm one robot in the middle plays sound 5 every five seconds, the other walks from a corner
// and, each time the mean of its volumes exceeds 60, stands still and sends it a message by Bluetooth. The
// time that counts is that of the walk, without the radio's pauses.
//
// Not published, so chosen here: the walk, and that the caller lets five seconds pass after each message.

#include "reproductions/exchange_log.h"
#include "reproductions/experiments.h"

#include <string>
#include <vector>

namespace puckloop::tools {

/// A time when the walker heard the caller, and what became of its message.
struct RadioAttempt {
    Heard heard;          ///< when and where
    double walked = 0.0;  ///< s of the walk until then
    double volume = 0.0;  ///< mean of the three, counts
    ReportedExchange exchange;
};

struct EarsRadio {
    std::vector<RadioAttempt> attempts;
    double walked = 0.0;                   ///< s, without the radio's pauses
    double lasted = 0.0;                   ///< s, with them
    int messages = 0;                      ///< that the caller wrote it has heard
    std::vector<physics::PathPoint> path;  ///< of the walker, without repetitions where it stands
};

/// What the walker wrote within `end` seconds: "walks", "hears 132", then of the exchange. Attempts that
/// begin within `walk_s` seconds of walking and have ended; their places are not known here.
EarsRadio read_walk(const std::vector<RobotLine>& lines, double walk_s, double end);

/// With `options.walker` (firmware/ears) on both robots; `options.walk_s` is the walk's time.
EarsRadio ears_with_radio(const SoundOptions& options);

/// "t_s,walked_s,x_m,y_m,volume,outcome,exchange_s", one line per attempt.
std::string ears_radio_csv(const EarsRadio& ears);
/// The field with the path, the places where it heard, those whose message failed, and their ellipse.
std::string ears_radio_picture(const EarsRadio& ears, const std::string& caption);

}  // namespace puckloop::tools
