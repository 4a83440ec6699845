#pragma once
// This program, or puckloop, as a process of its own.

#include <string>
#include <vector>

#include <spawn.h>
#include <sys/types.h>

namespace puckloop::jobs {

/// Starts it with these words behind its name; `actions` say what its standard streams are, and are
/// destroyed. Returns 0 and sets `id`, or the reason, an errno.
int start_self(std::vector<std::string> words, posix_spawn_file_actions_t& actions, pid_t& id);
/// The same of puckloop, which is this program or has it beside it.
int start_puckloop(std::vector<std::string> words, posix_spawn_file_actions_t& actions, pid_t& id);

}  // namespace puckloop::jobs
