#pragma once
// What posix_spawn() is to do with the descriptors of a new process.

#include <spawn.h>

#include <string>
#include <vector>

namespace puckloop::shim {

struct FileAction {
    enum class Kind { Open, Close, Copy, CloseFrom, ChangeFolder, ChangeFolderTo, TakeTerminal } kind{};
    int fd = 0;
    int copy = 0;  ///< Copy: the descriptor that it becomes; Open: flags
    mode_t mode = 0;
    std::string path;
};

/// What was added to `actions`, in order; nullptr if nobody initialised them.
const std::vector<FileAction>* actions_of(const posix_spawn_file_actions_t* actions);
/// Does them in this process, `kept` staying open; 0, or the error of the first that failed.
int take_actions(const std::vector<FileAction>& actions, int kept);

}  // namespace puckloop::shim
