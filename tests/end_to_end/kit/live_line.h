#pragma once
// A partner outside at a line of a run in progress: a program at its pty or a client at its TCP port.

#include "tests/end_to_end/kit/process.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace puckloop::tests {

/// False, with a warning, where the system has no pseudo terminals: the test is skipped.
bool has_ptys();

/// What the run, whose standard error is `err`, prints as the place of `end`: "/dev/pts/3", or "4242" of TCP.
/// Fails the test if it does not within 120 s.
std::string place_of(const std::filesystem::path& err, const std::string& end);

class LiveLine {
  public:
    enum class Kind : std::uint8_t { Pty, Tcp };
    /// Opens or connects; fails the test if that is not possible.
    LiveLine(Kind kind, const std::string& place);
    ~LiveLine();
    LiveLine(const LiveLine&) = delete;
    LiveLine& operator=(const LiveLine&) = delete;

    int file() const { return file_; }
    void send(const std::string& bytes) const;
    /// Bytes until they end with `end`, `patience` seconds of wall time are over, or the other side hangs up.
    std::string read_until(const std::string& end, double patience = 120.0) const;
    /// The other side hangs up within `patience` seconds, saying nothing.
    bool hung_up(double patience = 120.0) const;
    /// Sends `bytes` again and again until nothing is taken for half a second, at most `most` bytes in all;
    /// how many were taken.
    std::size_t flood(const std::string& bytes, std::size_t most) const;
    /// Leaves by a reset of the connection (TCP).
    void reset();

  private:
    int file_ = -1;
};

}  // namespace puckloop::tests
