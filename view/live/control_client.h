#pragma once
// A client's end of the control protocol (docs/control_protocol.md): one line of JSON each way.

#include <filesystem>
#include <string>

namespace puckloop::view {

class ControlClient {
  public:
    /// Connects to the run that control.json in `folder` names. Throws InputError: none that takes a client,
    /// one that has another, one of another protocol.
    explicit ControlClient(const std::filesystem::path& folder);
    ~ControlClient();
    ControlClient(const ControlClient&) = delete;
    ControlClient& operator=(const ControlClient&) = delete;

    /// control.json there names a run that goes on and takes a client.
    static bool is_there(const std::filesystem::path& folder);

    /// What the run said first, JSON.
    const std::string& greeting() const { return greeting_; }
    /// The reply to a request. Throws RunError when the run has closed the line.
    std::string ask(const std::string& request);

  private:
    std::string next_line();

    int socket_ = -1;
    std::string received_, greeting_;
};

}  // namespace puckloop::view
