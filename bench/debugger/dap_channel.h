#pragma once
// Messages of the Debug Adapter Protocol: a header with Content-Length, an empty line, JSON.
// Source: "Debug Adapter Protocol Specification", base protocol.

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop::exec::debugger {

/// Takes messages out of bytes as they come.
class DapReader {
  public:
    void add(std::string_view bytes) { pending_ += bytes; }
    /// The next whole message's content; nothing: more bytes are needed. Throws InputError for a header
    /// without a length, or with one above 16 MB: what follows cannot be read either.
    std::optional<std::string> next();

  private:
    std::string pending_;
};

class DapChannel {
  public:
    DapChannel(int in, int out) : in_(in), out_(out) {}

    /// The next message; waits for it if `wait`. Nothing: none has come, or closed(). Throws InputError: no
    /// DAP, or no JSON.
    std::optional<nlohmann::json> receive(bool wait);
    bool closed() const { return closed_; }
    void send(const nlohmann::json& message);

  private:
    /// False: nothing was there to read.
    bool read_some(bool wait);

    int in_, out_;
    bool closed_ = false;
    DapReader reader_;
};

}  // namespace puckloop::exec::debugger
