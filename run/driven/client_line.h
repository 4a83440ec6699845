#pragma once
// The line to the client of a driven run: a unix socket that only its user may use, one client at a time,
// JSON in lines each way.

#include <nlohmann/json_fwd.hpp>

#include <csignal>
#include <optional>
#include <string>

namespace puckloop::tools {

class ClientLine {
  public:
    /// Listens at `path`, whose folder exists. Throws RunError.
    explicit ClientLine(const std::string& path);
    ~ClientLine();
    ClientLine(const ClientLine&) = delete;
    ClientLine& operator=(const ClientLine&) = delete;

    /// Waits for a client; false: `interrupted` was set.
    bool await_client(const volatile std::sig_atomic_t* interrupted);
    /// The next line; nothing: the client is gone, or `interrupted` was set.
    std::optional<std::string> next(const volatile std::sig_atomic_t* interrupted);
    /// A client that is gone does not hear it.
    void send(const nlohmann::ordered_json& reply);
    bool connected() const { return client_ >= 0; }

  private:
    void drop();

    int listener_ = -1, client_ = -1;
    std::string text_;  ///< received, not yet a whole line
};

}  // namespace puckloop::tools
