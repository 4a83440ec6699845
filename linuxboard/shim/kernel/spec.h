#pragma once
// What a run states of one Linux program: how its node is described.

#include "base/fields/field.h"
#include "base/fields/json_value.h"
#include "cosim/core/seconds_form.h"
#include "cosim/core/time.h"
#include "cosim/faults/fault_json.h"
#include "linuxboard/shim/devices/camera_spec.h"
#include "linuxboard/shim/devices/tty_port.h"
#include "linuxboard/shim/network/network_spec.h"
#include "linuxboard/shim/wire/wire.h"

#include <csignal>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::linuxboard {

/// "INT", or the number where it has no name; "SIGINT" is read, too.
struct SignalForm {
    static JsonValue write(int signal);
    static void read(int& signal, const JsonValue& from, const std::string& place);
};
/// An error that an I2C driver gives: "EREMOTEIO".
struct I2cErrorForm {
    static JsonValue write(int number);
    static void read(int& number, const JsonValue& from, const std::string& place);
};
/// {"clock", "device", "sync", "thread", "yield"} in microseconds, each at least 0.001.
struct ChargesForm {
    static JsonValue write(const wire::Charges& charges);
    static void read(wire::Charges& charges, const JsonValue& from, const std::string& place);
};
/// {"mean_s", "jitter_s"}: how much later than asked sleeps end, below 0 earlier, and the standard deviation.
struct OversleepForm {
    static JsonValue write(const wire::Oversleep& oversleep);
    static void read(wire::Oversleep& oversleep, const JsonValue& from, const std::string& place);
};
/// {"NAME": "value"}.
struct EnvironmentForm {
    using List = std::vector<std::pair<std::string, std::string>>;
    static JsonValue write(const List& variables);
    static void read(List& variables, const JsonValue& from, const std::string& place);
};

/// A signal that the program gets at a simulated time.
struct TimedSignal {
    cosim::Time time = 0;
    int signal = 0;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("time_s", &TimedSignal::time, "when").in("s").at_least(0).as<cosim::Seconds>(),
                     field("signal", &TimedSignal::signal, "which").required().as<SignalForm>());
    }
};
static_assert(lists_all_fields<TimedSignal>);

/// The program is killed (SIGKILL) and started again.
struct Restart {
    cosim::Time time = 0;
    cosim::Time down = 0;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("time_s", &Restart::time, "when it is killed").in("s").at_least(0).as<cosim::Seconds>(),
            field("down_s", &Restart::down, "until it is started").in("s").at_least(0).as<cosim::Seconds>());
    }
};
static_assert(lists_all_fields<Restart>);

struct LinuxSpec {
    std::string name = "linux";
    std::string program;
    std::vector<std::string> args;
    std::vector<std::pair<std::string, std::string>> env;
    std::string cwd;
    std::string host_name = "epuck1";
    std::string tty = "/dev/ttyS0";
    std::vector<std::string> tty_aliases;
    int fifo_trigger = TtyPort::kTrigger;
    std::vector<std::string> i2c{"/dev/i2c-3"};
    std::vector<CameraSpec> cameras;
    std::optional<NetworkSpec> network;
    double i2c_hertz = 100'000.0;
    int i2c_nack_error = 121;  // EREMOTEIO
    double clock_ppm = 0.0;
    double system_clock_ppm = 0.0;
    cosim::Time tty_batch = 0;
    cosim::Time i2c_hold = 0;
    wire::Oversleep oversleep{};
    bool real_time = false;
    wire::Charges charges;
    std::int64_t epoch_s = 1'767'225'600;  // 2026-01-01T00:00:00Z
    double uptime_s = 60.0;
    std::uint64_t seed = 1;
    std::string log;
    bool echo_output = false;
    std::string stdin_file;
    cosim::Time start = 0;
    std::vector<Restart> restarts;
    std::vector<TimedSignal> signals;
    int end_signal = SIGTERM;
    cosim::Time grace = 2 * cosim::kSecond;
    std::vector<cosim::Time> hangups;
    bool exit_ends_run = true;
    std::uint32_t programs = 1;
    double watchdog_s = 5.0;
    bool ask_always = false;  ///< for tests: the library answers nothing by itself
    std::vector<cosim::CarriedFault> faults;
    std::string shim;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        using S = LinuxSpec;
        return visit(
            field("name", &S::name, "of the node"), field("program", &S::program, "file to run").required(),
            field("args", &S::args, "its arguments"),
            field("env", &S::env, "added to the runner's environment").as<EnvironmentForm>(),
            field("cwd", &S::cwd, "folder to work in; empty: the runner's"),
            field("host_name", &S::host_name, "what gethostname() gives, at most 63 characters"),
            field("tty", &S::tty, "the serial port; empty: none"),
            field("tty_aliases", &S::tty_aliases, "other names of the serial port"),
            field("fifo_trigger", &S::fifo_trigger, "of the UART's receive FIFO").within(1, 64),
            field("i2c", &S::i2c, "names of the one adapter at the port i2c"),
            field("cameras", &S::cameras, "in the order of the node's scenery"),
            field("network", &S::network, "that the port network is on; none: sockets are the host's"),
            field("i2c_hertz", &S::i2c_hertz, "clock of the adapter").in("Hz").above(0),
            field("i2c_nack_error", &S::i2c_nack_error, "errno where no slave acknowledges")
                .as<I2cErrorForm>(),
            field("clock_ppm", &S::clock_ppm, "error of the board's clock, for the baud rate").in("ppm"),
            field("system_clock_ppm", &S::system_clock_ppm,
                  "error of the clocks that programs read, + is fast")
                .in("ppm")
                .within(-10'000, 10'000),
            field("tty_batch_s", &S::tty_batch,
                  "the driver hands received bytes on at whole multiples of this; 0: at once")
                .in("s")
                .at_least(0)
                .as<cosim::Seconds>(),
            field("i2c_hold_s", &S::i2c_hold, "for so long each transfer waits for the bus before its START")
                .in("s")
                .at_least(0)
                .as<cosim::Seconds>(),
            field("oversleep", &S::oversleep, "of nanosleep, usleep, sleep and clock_nanosleep")
                .as<OversleepForm>(),
            field("real_time", &S::real_time, "the program's time is never behind the wall clock"),
            field("charges_us", &S::charges, "what calls cost, by class").as<ChargesForm>(),
            field("epoch_s", &S::epoch_s, "wall clock at simulated time 0, since 1970").in("s"),
            field("uptime_s", &S::uptime_s, "CLOCK_MONOTONIC at simulated time 0").in("s"),
            field("seed", &S::seed, "of the run"),
            field("log", &S::log, "file for the program's output; empty: discarded"),
            field("echo_output", &S::echo_output, "what goes to the log is also shown"),
            field("stdin", &S::stdin_file, "file; empty: /dev/null"),
            field("start_s", &S::start, "when the program is started")
                .in("s")
                .at_least(0)
                .as<cosim::Seconds>(),
            field("restart_at", &S::restarts, "kills and starts, rising"),
            field("signals", &S::signals, "signals, in order of time"),
            field("end_signal", &S::end_signal, "what the program gets when the run is to end")
                .as<SignalForm>(),
            field("grace_s", &S::grace, "from that to SIGKILL").in("s").at_least(0).as<cosim::Seconds>(),
            field("hangup_at", &S::hangups, "when the serial port hangs up").in("s").as<cosim::Seconds>(),
            field("exit_ends_run", &S::exit_ends_run, "the run ends with the programs"),
            field("programs", &S::programs, "of the run: the last of so many to end well ends it"),
            field("watchdog_s", &S::watchdog_s,
                  "wall-clock time that a program may compute without letting time pass")
                .in("s")
                .not_in(Comparison::Run),
            unlisted(&S::ask_always), unlisted(&S::faults),
            field("shim", &S::shim, "the preloaded library; empty: the one built with this program"));
    }
};
static_assert(lists_all_fields<LinuxSpec>);

/// Throws InputError naming the key: no program, a name too long, times that do not rise.
void check(const LinuxSpec& spec);

/// From JSON text, checked. Throws InputError naming the key.
LinuxSpec parse_linux_spec(std::string_view json);

/// `system_clock_ppm` as wire/board_clock.h has it.
std::int64_t clock_error_of(const LinuxSpec& spec);

/// "INT" or "SIGINT"; nothing for what is no signal.
std::optional<int> signal_named(std::string_view name);

}  // namespace puckloop::linuxboard
