// The C library keeps file actions in a form of its own, so they are written down here as they are added.

#include "linuxboard/shim/preload/processes/file_actions.h"

#include "linuxboard/shim/preload/host/real.h"

#include <fcntl.h>
#include <limits.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <map>

namespace puckloop::shim {

namespace {
/// Never destroyed: programs spawn until their end.
std::map<const posix_spawn_file_actions_t*, std::vector<FileAction>>& lists() {
    static auto* const all = new std::map<const posix_spawn_file_actions_t*, std::vector<FileAction>>;
    return *all;
}

/// `error` of the C library's function; what it took is written down.
int written_down(int error, const posix_spawn_file_actions_t* actions, FileAction action) {
    if (error == 0) lists()[actions].push_back(std::move(action));
    return error;
}

int open_as(const FileAction& action) {
    close(action.fd);
    const int opened = open(action.path.c_str(), action.copy, action.mode);
    if (opened < 0 || opened == action.fd) return opened;
    const int moved = dup2(opened, action.fd);
    if (moved >= 0 && (action.copy & O_CLOEXEC) != 0) fcntl(moved, F_SETFD, FD_CLOEXEC);
    close(opened);
    return moved;
}

int take(const FileAction& action, int kept) {
    switch (action.kind) {
    case FileAction::Kind::Open:
        return open_as(action);
    case FileAction::Kind::Close:
        close(action.fd);  // one that is not open is none to fail for
        return 0;
    case FileAction::Kind::Copy:
        if (action.fd != action.copy) return dup2(action.fd, action.copy);
        return fcntl(action.fd, F_SETFD, fcntl(action.fd, F_GETFD) & ~FD_CLOEXEC);
    case FileAction::Kind::CloseFrom:
        if (action.fd < kept)
            close_range(static_cast<unsigned>(action.fd), static_cast<unsigned>(kept - 1), 0);
        return close_range(static_cast<unsigned>(std::max(action.fd, kept + 1)), UINT_MAX, 0);
    case FileAction::Kind::ChangeFolder:
        return chdir(action.path.c_str());
    case FileAction::Kind::ChangeFolderTo:
        return fchdir(action.fd);
    case FileAction::Kind::TakeTerminal:
        return tcsetpgrp(action.fd, getpgrp());
    }
    return 0;
}
}  // namespace

const std::vector<FileAction>* actions_of(const posix_spawn_file_actions_t* actions) {
    const auto found = lists().find(actions);
    return actions == nullptr || found == lists().end() ? nullptr : &found->second;
}

int take_actions(const std::vector<FileAction>& actions, int kept) {
    for (const FileAction& action : actions)
        if (take(action, kept) < 0) return errno;
    return 0;
}

}  // namespace puckloop::shim

using namespace puckloop::shim;
using Kind = FileAction::Kind;

SHIM_EXPORT int posix_spawn_file_actions_init(posix_spawn_file_actions_t* actions) noexcept {
    lists()[actions].clear();
    return REAL(posix_spawn_file_actions_init)(actions);
}

SHIM_EXPORT int posix_spawn_file_actions_destroy(posix_spawn_file_actions_t* actions) noexcept {
    lists().erase(actions);
    return REAL(posix_spawn_file_actions_destroy)(actions);
}

SHIM_EXPORT int posix_spawn_file_actions_addopen(posix_spawn_file_actions_t* actions, int fd,
                                                 const char* path, int flags, mode_t mode) noexcept {
    return written_down(REAL(posix_spawn_file_actions_addopen)(actions, fd, path, flags, mode), actions,
                        {Kind::Open, fd, flags, mode, path});
}

SHIM_EXPORT int posix_spawn_file_actions_addclose(posix_spawn_file_actions_t* actions, int fd) noexcept {
    return written_down(REAL(posix_spawn_file_actions_addclose)(actions, fd), actions,
                        {Kind::Close, fd, 0, 0, {}});
}

SHIM_EXPORT int posix_spawn_file_actions_adddup2(posix_spawn_file_actions_t* actions, int fd,
                                                 int copy) noexcept {
    return written_down(REAL(posix_spawn_file_actions_adddup2)(actions, fd, copy), actions,
                        {Kind::Copy, fd, copy, 0, {}});
}

SHIM_EXPORT int posix_spawn_file_actions_addclosefrom_np(posix_spawn_file_actions_t* actions,
                                                         int first) noexcept {
    return written_down(REAL(posix_spawn_file_actions_addclosefrom_np)(actions, first), actions,
                        {Kind::CloseFrom, first, 0, 0, {}});
}

SHIM_EXPORT int posix_spawn_file_actions_addchdir_np(posix_spawn_file_actions_t* actions,
                                                     const char* path) noexcept {
    return written_down(REAL(posix_spawn_file_actions_addchdir_np)(actions, path), actions,
                        {Kind::ChangeFolder, 0, 0, 0, path});
}

SHIM_EXPORT int posix_spawn_file_actions_addfchdir_np(posix_spawn_file_actions_t* actions, int fd) noexcept {
    return written_down(REAL(posix_spawn_file_actions_addfchdir_np)(actions, fd), actions,
                        {Kind::ChangeFolderTo, fd, 0, 0, {}});
}

SHIM_EXPORT int posix_spawn_file_actions_addtcsetpgrp_np(posix_spawn_file_actions_t* actions,
                                                         int fd) noexcept {
    return written_down(REAL(posix_spawn_file_actions_addtcsetpgrp_np)(actions, fd), actions,
                        {Kind::TakeTerminal, fd, 0, 0, {}});
}
