#pragma once
// The options of `puckloop exec`, checked and resolved.

#include "bench/bench.h"
#include "bench/bench_instruments.h"
#include "ends/uart_spec.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::exec {

/// As the command line gave them.
struct ExecOptions {
    BenchOptions bench;
    std::string image;
    std::optional<double> seconds;                   ///< budget in simulated time
    std::optional<std::uint64_t> cycles;             ///< budget in instruction cycles
    std::vector<std::string> stop_at;                ///< symbols, 0xPC or FILE:LINE
    std::array<std::optional<std::string>, 2> uart;  ///< --uart1, --uart2
    std::string i2c;                                 ///< script:FILE, or empty
    std::vector<std::string> i2c_devices;            ///< --i2c-device
    I2cMasterOptions i2c_master;
    std::string stimulus;              ///< file
    std::optional<double> uart_start;  ///< seconds
    std::optional<bool> realtime;      ///< nothing: paced if an end is live
    bool list_signals = false;
    bool json = false;
    std::string nvm;             ///< file that keeps flash and EEPROM, or empty
    std::vector<double> resets;  ///< seconds: the reset button is pressed
    std::string gdb;             ///< where a debugger connects, or empty
    InstrumentOptions instruments;
    bool strict = false;  ///< what is worth a warning makes the run a failed one
};

/// What is around a bench.
struct Surroundings {
    bool live = false;   ///< somebody is at an end: the run is paced by the wall clock unless asked otherwise
    bool stdio = false;  ///< an end is at standard input and output
};
/// Puts the ends, the bus master, the stimulus and the resets of these options to a bench whose image was
/// read. Throws InputError.
Surroundings surround(Bench& bench, const ExecOptions& options);

/// Address to stop at, and what the user called it.
struct StopAddress {
    std::uint32_t pc = 0;
    std::string name;
};

/// Runs the bench; returns the exit status (0 or 1). Throws InputError for anything that cannot be used.
int run_exec(const ExecOptions& options);

/// Program addresses where the code of a source line begins; none where the line has no code.
using LineLookup = std::function<std::vector<std::uint32_t>(const std::string& file, std::uint32_t line)>;

/// `text` is 0xPC (even, a program address), a symbol of the image, or FILE:LINE where the image has source
/// lines (then perhaps several addresses); throws InputError with a suggestion.
std::vector<StopAddress> resolve_stop(const std::string& text, const image::Image& image,
                                      const LineLookup& lines);

}  // namespace puckloop::exec
