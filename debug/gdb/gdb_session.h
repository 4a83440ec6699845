#pragma once
// One debugger's conversation in GDB's remote serial protocol, from connecting to detaching.
// Source: GDB manual, appendix E, "GDB Remote Serial Protocol".

#include "debug/debuggee.h"
#include "debug/gdb/gdb_socket.h"
#include "debug/gdb/rsp_packet.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop::debug {

/// What a debugger wants of a program that stands still.
enum class Resume : std::uint8_t { Step, Continue, ReverseStep, ReverseContinue, Detach, Kill };

class GdbSession {
  public:
    /// `cancelled`: the run is to end (Ctrl-C at its own terminal), asked while waiting.
    GdbSession(GdbSocket& socket, Debuggee& debuggee, std::function<bool()> cancelled)
        : socket_(socket), debuggee_(debuggee), cancelled_(std::move(cancelled)) {}

    /// The program stands still: reports it, if the debugger waits for that, and answers until it is to go
    /// on. A debugger that has left is one that detaches,
    /// which a line on standard error reports.
    Resume serve(const Stop& stop);
    /// The same in parts, for whoever has several debuggers. The program stands still from here on.
    void on_stop(const Stop& stop);
    /// Answers what has come, waiting for something if `wait`; what the debugger wants once it wants the
    /// program to go on.
    std::optional<Resume> poll(bool wait);
    /// While the program runs: the debugger wants it to stop, or has left.
    bool wants_stop();
    /// The run is over with this exit status.
    void on_exit(int status);

    /// The answer to one packet; empty text is "not supported". Public for tests.
    std::string answer(std::string_view packet);

  private:
    void send(std::string_view data);
    std::string stop_reply() const;
    std::string query(std::string_view packet);
    std::string transfer(std::string_view packet) const;
    std::string read_registers() const;
    std::string write_registers(std::string_view hex);
    std::string one_register(std::string_view packet, bool write);
    std::string memory(std::string_view packet, bool write, bool binary);
    std::string point(std::string_view packet, bool insert);
    std::string resume(Resume how, std::string_view address = {});
    std::string changed(std::function<bool(DebugChip&)> change);

    GdbSocket& socket_;
    Debuggee& debuggee_;
    std::function<bool()> cancelled_;
    RspReader reader_;
    std::string last_;
    bool acknowledges_ = true;
    bool stop_acknowledging_ = false;
    bool awaited_ = false;  ///< the debugger waits for a stop reply
    Stop stop_;
    std::optional<Resume> resume_;
};

/// What `monitor TEXT` prints.
std::string monitor(Debuggee& debuggee, std::string_view text);
/// The target description; empty where GDB's own knowledge of the family is better.
std::string target_description(const DebugChip& chip);

}  // namespace puckloop::debug
