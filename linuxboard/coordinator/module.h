#pragma once
// The XBee module at the serial port, as a host sees it: API frames, escaped (AP = 2), out and in.

#include "linuxboard/control/devices/transport.h"
#include "protocols/radio/xbee_frame.h"
#include "protocols/radio/xbee_message.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop::coordinator {

class Module {
  public:
    struct Counters {
        std::uint64_t bytes = 0;   ///< received
        std::uint64_t frames = 0;  ///< received and sound
        std::uint64_t faults = 0;  ///< noise, and frames that are not sound
        std::uint64_t sent = 0;    ///< frames
    };
    using Receiver = std::function<void(const protocols::XBeeMessage&)>;
    /// Called with one line about something that is no sound frame.
    using FaultLog = std::function<void(const std::string&)>;

    /// `receiver` and `faults` are called by listen() and ask() only.
    Module(control::Transport& line, Receiver receiver, FaultLog faults);

    /// Throws control::LineError, as all others here do.
    void send(const protocols::XBeeMessage& message);
    /// Hands on what comes in until `until`; looks at the line at least once.
    void listen(double until);
    /// Sends an AT command and waits until `until` for its response; all else that comes in is handed on.
    /// `ended` is asked after each look at the line. Nothing: no answer, or ended.
    std::optional<protocols::XBeeAtResponse> ask(std::string_view command, protocols::XBeeBytes value,
                                                 double until, const std::function<bool()>& ended);

    double now() { return line_.now(); }
    const Counters& counters() const { return counters_; }

  private:
    void read_once(double until);
    void take(std::uint8_t byte);

    control::Transport& line_;
    Receiver receiver_;
    FaultLog faults_;
    protocols::XBeeReader reader_{protocols::XBeeApiMode::Escaped};
    Counters counters_;
    const protocols::XBeeCommand* awaited_ = nullptr;
    std::optional<protocols::XBeeAtResponse> response_;
};

/// The command was refused; the status' upper half is flags of the module's own (found nodes: 40).
inline bool failed(const protocols::XBeeAtResponse& response) {
    return (response.status & 0x0F) != 0;
}

/// The letters of an AT command, of exactly two.
protocols::XBeeCommand command_of(std::string_view letters);

}  // namespace puckloop::coordinator
