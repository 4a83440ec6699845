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
    /// Listens at `path`, whose folder exists. Once `interrupted` is set (null: never), nobody is waited for.
    /// Throws RunError.
    ClientLine(const std::string& path, const volatile std::sig_atomic_t* interrupted);
    ~ClientLine();
    ClientLine(const ClientLine&) = delete;
    ClientLine& operator=(const ClientLine&) = delete;

    /// Waits for a client; false: `interrupted` was set.
    bool await_client();
    /// The next line; nothing: the client is gone, has sent a line of more than 1 MB, or `interrupted` was
    /// set.
    std::optional<std::string> next();
    /// Waits for a client that does not read. One that is gone does not hear it.
    void send(const nlohmann::ordered_json& reply);
    bool connected() const { return client_ >= 0; }

  private:
    void drop();

    const volatile std::sig_atomic_t* interrupted_;
    int listener_ = -1, client_ = -1;
    std::string text_;  ///< received, not yet a whole line
};

}  // namespace puckloop::tools
