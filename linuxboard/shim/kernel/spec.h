#pragma once
// What a scenario states of one Linux program: the JSON text from which its node is made.

#include "cosim/core/time.h"
#include "cosim/faults/fault_json.h"
#include "linuxboard/shim/devices/tty_port.h"
#include "linuxboard/shim/wire/wire.h"

#include <csignal>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::linuxboard {

/// A signal that the program gets at a simulated time.
struct TimedSignal {
    cosim::Time time = 0;
    int signal = 0;
};

/// The program is killed (SIGKILL) at `time` and started anew after `down`.
struct Restart {
    cosim::Time time = 0;
    cosim::Time down = 0;
};

/// A camera of the board. What it sees comes from whoever made the node.
struct CameraSpec {
    std::string device = "/dev/video0";
    std::string card = "e-puck camera";  ///< as VIDIOC_QUERYCAP gives it
    std::string log;                     ///< CSV file with a line per frame; empty: none
    std::string save;                    ///< folder for the pictures; empty: none are kept
    std::uint32_t save_every = 1;        ///< keep one of so many
};

struct LinuxSpec {
    std::string name = "linux";
    std::string program;
    std::vector<std::string> args;
    std::vector<std::pair<std::string, std::string>> env;  ///< added to the runner's environment
    std::string cwd;
    std::string host_name = "epuck1";
    std::string tty = "/dev/ttyS0";              ///< empty: no serial port
    int fifo_trigger = TtyPort::kTrigger;        ///< of the UART's receive FIFO, 1..64
    std::vector<std::string> i2c{"/dev/i2c-3"};  ///< names of the one adapter at the port `i2c`
    std::vector<CameraSpec> cameras;             ///< in the order of the node's scenery
    double i2c_hertz = 100'000.0;
    int i2c_nack_error = 121;   ///< errno value where no slave acknowledges: EREMOTEIO, ENXIO, ...
    double clock_ppm = 0.0;     ///< error of the board's clock, for the baud rate
    cosim::Time tty_batch = 0;  ///< the driver hands received bytes on at whole multiples of this; 0: at once
    cosim::Time i2c_hold = 0;   ///< for so long each transfer waits for the bus before its START
    wire::Oversleep oversleep{};  ///< of nanosleep, usleep, sleep and clock_nanosleep
    bool real_time = false;
    wire::Charges charges;
    std::int64_t epoch_s = 1'767'225'600;  ///< wall clock at simulated time 0: 2026-01-01T00:00:00Z
    double uptime_s = 60.0;                ///< CLOCK_MONOTONIC at simulated time 0
    std::uint64_t seed = 1;
    std::string log;           ///< file for the program's output; empty: discarded
    bool echo_output = false;  ///< what goes to the log is also shown on standard output
    std::string stdin_file;    ///< empty: /dev/null
    cosim::Time start = 0;
    std::vector<Restart> restarts;
    std::vector<TimedSignal> signals;
    int end_signal = SIGTERM;                ///< what the program gets when the run is to end
    cosim::Time grace = 2 * cosim::kSecond;  ///< SIGKILL so much later
    std::vector<cosim::Time> hangups;
    bool exit_ends_run = true;
    std::uint32_t programs = 1;  ///< of the run: the last of so many to end well ends it
    double watchdog_s = 5.0;     ///< wall-clock seconds a program may compute without letting time pass
    bool ask_always = false;     ///< no key; for tests: the library answers nothing by itself
    std::vector<cosim::CarriedFault> faults;
    std::string shim;  ///< the preloaded library; empty: the one built with this program
};

/// Throws InputError naming the key. Keys are the members above; times in seconds (`start_s`, `down_s`,
/// `hangup_at`, `grace_s`, `tty_batch_s`, `i2c_hold_s`, `oversleep_s`, `oversleep_jitter_s`), charges in
/// microseconds.
LinuxSpec parse_linux_spec(std::string_view json);

}  // namespace puckloop::linuxboard
