#pragma once
// A client that speaks to a server as it likes: raw bytes over a socket of 127.0.0.1.

#include "tests/end_to_end/kit/process.h"

#include <cstdint>
#include <memory>
#include <string>

namespace puckloop::tests {

class Connection {
  public:
    /// Connects; id() is -1 if that fails.
    explicit Connection(std::uint16_t port);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    int id() const { return socket_; }
    bool send(const std::string& bytes) const;
    /// What comes until an answer is whole (by its Content-Length), the other side closes or `limit` seconds
    /// are over.
    std::string answer(double limit = 20.0) const;
    /// The other side has closed within `limit` seconds.
    bool closed(double limit) const;

  private:
    int socket_ = -1;
};

/// `puckloop view FOLDER` that runs.
struct Viewer {
    std::unique_ptr<Process> process;
    std::uint16_t port = 0;
    std::string token;

    std::string host() const { return "127.0.0.1:" + std::to_string(port); }
    /// A request with the right host; `rest` after the token.
    std::string request(const std::string& rest, const std::string& more = {}) const;
    /// Its answer, on a connection of its own.
    std::string get(const std::string& rest) const;
};

/// Starts it and waits for its address (Catch2's REQUIRE).
Viewer start_viewer(const std::filesystem::path& folder, const std::filesystem::path& scratch);

/// "200" of "HTTP/1.1 200 OK".
std::string status_of(const std::string& answer);

}  // namespace puckloop::tests
