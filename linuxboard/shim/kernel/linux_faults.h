#pragma once
// The faults of one Linux program: in its calls on the serial port and the I2C adapter, and of its process.
// Kinds and parameters: cosim/faults/kinds/linux_kinds.cpp.

#include "cosim/core/time.h"
#include "cosim/faults/fault_json.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <termios.h>

namespace puckloop::linuxboard {

/// What becomes of one read or write.
struct CallDamage {
    int error = 0;                ///< errno value that it fails with; 0: none
    std::size_t most = SIZE_MAX;  ///< bytes that it moves
};

/// What happens to the process at one instant.
struct ProcessDamage {
    cosim::Time paused_until = 0;  ///< it makes no call before
    bool killed = false;
    bool ends_run = false;                      ///< killed, and the run is to end with it
    std::optional<cosim::Time> restarted_at{};  ///< killed, and started anew
    bool hung_up = false;                       ///< the serial port is gone
    std::optional<double> charge_factor{};      ///< from now on, of what each call costs
};

class LinuxFaults {
  public:
    /// Throws InputError for a kind that a Linux program cannot suffer.
    explicit LinuxFaults(std::vector<cosim::CarriedFault> faults);

    bool empty() const { return faults_.empty(); }
    /// Some fault concerns reads or writes: the library may not answer them by itself.
    bool watches_calls() const { return watches_calls_; }
    /// A restart is still to come at or after `now`.
    bool restarts_after(cosim::Time now) const;

    CallDamage read(cosim::Time now, std::size_t bytes);
    CallDamage write(cosim::Time now, std::size_t bytes);
    /// errno value that the transfer fails with, 0: none. `addresses` of its messages.
    int transfer(cosim::Time now, const std::vector<std::uint16_t>& addresses);
    /// The settings that take effect where the program asks for `wanted`.
    termios configure(cosim::Time now, const termios& before, const termios& wanted);
    /// The port's bit rate over the one of its settings, as the last configure() left it.
    double rate_factor() const { return rate_factor_; }

    /// What becomes of a name that the program asks for.
    struct Resolution {
        cosim::Time until = 0;  ///< it waits so long
        bool failed = false;
    };
    Resolution resolve(cosim::Time now, std::string_view name);
    /// A question to the board's resolver gets no answer.
    bool silences(cosim::Time now, std::string_view name);
    /// Some fault concerns names of computers.
    static bool concern_names(const std::vector<cosim::CarriedFault>& faults);

    /// When something next happens to the process; kNever: nothing more.
    cosim::Time next() const;
    /// What is due at `now`; `runs`: there is a process that it can happen to.
    ProcessDamage happen(cosim::Time now, bool runs);

    const std::vector<cosim::CarriedFault>& carried() const { return faults_; }

  private:
    enum class Kind : std::uint8_t {
        ReadError,
        WriteError,
        ShortRead,
        ShortWrite,
        TermiosRefused,
        TermiosBaud,
        I2cError,
        HangUp,
        Pause,
        Starve,
        Kill,
        Restart,
        DnsSilence,
    };
    static constexpr Kind kLast = Kind::DnsSilence;
    static std::optional<Kind> kind_of(std::string_view name);

    CallDamage strike(cosim::Time now, std::size_t bytes, Kind error, Kind shortens, const char* call);
    void at_instant(std::size_t index, cosim::Time now, ProcessDamage& damage);

    std::vector<cosim::CarriedFault> faults_;
    std::vector<Kind> kinds_;        // of faults_
    std::vector<cosim::Time> next_;  // of faults_: instants, and begin and end of Starve
    std::uint64_t calls_ = 0;
    bool watches_calls_ = false;
    double rate_factor_ = 1.0;
};

}  // namespace puckloop::linuxboard
