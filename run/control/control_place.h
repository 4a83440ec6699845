#pragma once
// Where a running world takes commands: a socket in a folder that only its user may enter, named in the
// results folder's control.json.

#include <filesystem>
#include <optional>
#include <string>

namespace puckloop::tools {

/// A path for the socket that nobody has yet; nothing is made.
std::string new_control_path();

/// Beside the world's socket, in the same private folder: where the client of a driven run speaks
/// (run/driven/driven_run.h).
std::string client_socket_beside(const std::string& socket);

/// Where the program of a joined port listens (run/nodes/joined_ports.h).
std::string joined_socket_beside(const std::string& socket, unsigned port);

/// While it lives: the private folder (mode 0700) of the socket, and control.json, which gives its place.
/// Afterwards control.json states that the run has ended.
class ControlPlace {
  public:
    /// `socket` empty: the run takes no commands. control.json of an earlier run is removed, and if that run
    /// was killed, its socket as well; so are private folders that killed runs of this user left elsewhere.
    /// Throws RunError.
    ControlPlace(std::string socket, const std::filesystem::path& results);
    ~ControlPlace();
    ControlPlace(const ControlPlace&) = delete;
    ControlPlace& operator=(const ControlPlace&) = delete;

    /// control.json names the client's socket too: whoever reads it there is let in. Throws RunError.
    void name_client_socket();

  private:
    std::string socket_;
    std::filesystem::path note_;
};

/// The socket of a run, by its results folder or, in out/, by its name. Throws InputError: no such run, one
/// that takes no commands, one that has ended.
std::string control_path_of(const std::string& run);

}  // namespace puckloop::tools
