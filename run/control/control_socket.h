#pragma once
// The world's end of `puckloop act`: a unix socket that only its user may use. One line of JSON each way:
// {"act": "move can to ..."} or {"list": true}; replies as physics/events/command_source.h has them.

#include "physics/events/command_source.h"

#include <memory>
#include <string>

namespace puckloop::tools {

/// Listens at `path`, whose folder exists; looks at it only when polled. Throws RunError.
std::unique_ptr<physics::CommandSource> make_control_socket(const std::string& path);

/// There is a socket at `path`, and its process has ended.
bool is_left_over(const std::string& path);

/// The other end: sends `request`, returns the reply. Throws InputError when nobody is there (any more) or
/// the run is another user's, RunError after `seconds` of wall-clock time without a reply.
std::string ask(const std::string& run, const std::string& path, const std::string& request, double seconds);

}  // namespace puckloop::tools
