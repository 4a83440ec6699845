#pragma once
// Where a debugger connects: a TCP port on 127.0.0.1, or a Unix-domain socket. One debugger at a time.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace puckloop::debug {

class GdbSocket {
  public:
    /// ":PORT" (0: a free one) or "unix:PATH". Throws InputError naming `option`: not such a text, or the
    /// place is taken.
    GdbSocket(std::string_view option, const std::string& where);
    ~GdbSocket();
    GdbSocket(const GdbSocket&) = delete;
    GdbSocket& operator=(const GdbSocket&) = delete;

    /// "127.0.0.1:4242" or the path.
    const std::string& address() const { return address_; }
    bool connected() const { return client_ >= 0; }
    /// Where something is to be heard next: the debugger, or who wants to be it.
    int descriptor() const { return connected() ? client_ : listener_; }
    /// Waits for a debugger; false: `gives_up` (asked every tenth of a second) said so.
    bool accept(const std::function<bool()>& gives_up);
    /// Takes a debugger that waits, if there is one.
    bool accept_now();
    /// Reads what has come; waits for something if `wait`, until `gives_up`. Empty: nothing came, or the
    /// debugger has left (then it is not connected() any more).
    std::span<const char> read(bool wait, const std::function<bool()>& gives_up);
    void write(std::string_view text);
    void hang_up();

  private:
    bool await(int descriptor, bool wait, const std::function<bool()>& gives_up) const;

    int listener_ = -1, client_ = -1;
    std::string address_, path_;
    char buffer_[0x4000];
};

}  // namespace puckloop::debug
