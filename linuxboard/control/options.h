#pragma once
// The command line of puckloop-control.

#include "linuxboard/control/behaviours/machine_text.h"
#include "linuxboard/control/control_loop.h"
#include "linuxboard/control/option_values.h"
#include "linuxboard/control/rab/rab_link.h"

#include <string>
#include <vector>

namespace puckloop::control {

inline constexpr char kDefaultBus[] = "/dev/i2c-3";
inline constexpr char kDefaultCamera[] = "/dev/video1";

struct Options {
    std::string behaviour = "wander";
    std::vector<MachineState> machine{};  ///< of the behaviour "machine"
    std::string tty = "/dev/ttyS0";
    std::string i2c;  ///< empty: kDefaultBus if it is there
    bool ground = true;
    std::string camera{};  ///< empty: none
    bool rab = false;
    bool rab_required = false;
    int calibrate = 0;  ///< messages; 0: no calibration
    int rab_id = 0;
    double rab_gain = 1;
    RabBoardSettings board;
    RabLinkSettings link;
    LoopSettings loop;
};

/// Ends the program with a message and status 2 on wrong use, with the usage and status 0 on --help.
Options parse_options(int argc, char** argv);

}  // namespace puckloop::control
