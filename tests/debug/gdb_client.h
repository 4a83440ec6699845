#pragma once
// `puckloop exec --gdb` and a debugger of our own at its socket: packets out, packets in.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop::tests {

/// A run that waits for a debugger at a socket in `folder`. Ended, if it still runs, with the object.
class GdbServer {
  public:
    /// `arguments` of `puckloop exec`, --gdb left out.
    GdbServer(const std::string& folder, const std::string& arguments);
    /// `puckloop ARGUMENTS`, with {} for the socket's path.
    struct Whole {};
    GdbServer(const std::string& folder, std::string arguments, Whole);
    ~GdbServer();
    GdbServer(const GdbServer&) = delete;
    GdbServer& operator=(const GdbServer&) = delete;

    const std::string& socket() const { return socket_; }
    /// What it wrote on standard output and standard error so far.
    std::string out() const;
    std::string err() const;
    /// Waits until it prints that it listens, at most 30 s: GDB itself does not.
    void await_listening() const;
    /// Waits for its end; the exit status, -1 for a signal. At most 60 s.
    int wait();

  private:
    std::string folder_, socket_;
    int process_ = -1;
};

class GdbClient {
  public:
    /// Connects, waiting at most 30 s for somebody who listens. Fails the test otherwise.
    explicit GdbClient(const std::string& socket);
    ~GdbClient();
    GdbClient(const GdbClient&) = delete;
    GdbClient& operator=(const GdbClient&) = delete;

    /// The answer to a packet. Fails the test if none comes within 60 s, or one with a wrong checksum.
    std::string ask(std::string_view packet);
    /// Bytes as they are, nothing awaited.
    void send_raw(std::string_view bytes);
    void send(std::string_view packet);
    /// The next packet; nothing: the other side has hung up.
    std::optional<std::string> receive();
    /// `monitor TEXT`: what is printed.
    std::string monitor(std::string_view text);
    std::uint64_t register_value(unsigned number);

  private:
    std::optional<char> byte();

    int socket_ = -1;
    std::string buffer_;
    std::size_t taken_ = 0;
};

}  // namespace puckloop::tests
