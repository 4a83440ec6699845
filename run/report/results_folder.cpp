#include "run/report/results_folder.h"

#include "base/error.h"
#include "base/files/claimed_folder.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>

namespace puckloop::tools {

namespace fs = std::filesystem;

namespace {

/// Over the whole file; the kernel lets go of it when the process ends, however it does.
struct flock whole_file() {
    struct flock range {};
    range.l_type = F_WRLCK;
    range.l_whence = SEEK_SET;
    return range;
}

}  // namespace

ResultsFolder::ResultsFolder(const fs::path& folder, const std::vector<std::string>& files,
                             const std::vector<std::string>& kept)
    : folder_(folder), file_(folder / kRunMark) {
    std::error_code failed;
    fs::create_directories(folder, failed);
    if (failed) throw InputError(folder.string(), "", "cannot be made a folder: " + failed.message());
    std::vector<std::string> written = files;
    for (const std::string& name : kept)  // into a folder is written, not over it
        if (!fs::is_directory(fs::symlink_status(folder / name, failed))) written.push_back(name);
    refuse_foreign_results(folder, kRunMark, written);
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (descriptor_ < 0)
        throw InputError(file_.string(), "", fmt::format("cannot be opened: {}", std::strerror(errno)),
                         "a folder for results that can be written");
    try {
        lock();
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
    remove_listed();
    list(files, kept);
}

ResultsFolder::~ResultsFolder() {
    ::close(descriptor_);
}

void ResultsFolder::lock() const {
    struct flock wanted = whole_file();
    while (::fcntl(descriptor_, F_SETLK, &wanted) != 0) {
        const int reason = errno;
        if (reason == EINTR) continue;
        struct flock holder = whole_file();
        const bool held = reason == EAGAIN || reason == EACCES;
        if (!held || ::fcntl(descriptor_, F_GETLK, &holder) != 0)
            throw InputError(file_.string(), "", fmt::format("cannot be locked: {}", std::strerror(reason)),
                             "a folder on a file system with locks");
        if (holder.l_type == F_UNLCK) continue;  // it has just ended
        throw InputError(folder_.string(), "",
                         fmt::format("process {} writes the results of its run there", holder.l_pid),
                         "another --out, or that run's end");
    }
}

/// Read by the descriptor that holds the lock: closing another one of this file would give the lock back.
std::string ResultsFolder::listed() const {
    std::string text;
    char piece[4096];
    for (ssize_t got; (got = ::pread(descriptor_, piece, sizeof piece, static_cast<off_t>(text.size()))) > 0;)
        text.append(piece, static_cast<std::size_t>(got));
    return text;
}

void ResultsFolder::remove_listed() const {
    std::istringstream list(listed());
    std::error_code failed;
    for (std::string name; std::getline(list, name);) {
        const fs::path file = folder_ / name;
        // Whatever else the list may hold, only plain files of this very folder go; "./NAME" stays.
        if (name.empty() || fs::path(name).filename() != name) continue;
        if (fs::is_regular_file(fs::symlink_status(file, failed))) fs::remove(file, failed);
    }
}

void ResultsFolder::list(const std::vector<std::string>& files, const std::vector<std::string>& kept) const {
    std::string text;
    for (const std::string& name : files)
        text += name + '\n';
    for (const std::string& name : kept)
        text += "./" + name + '\n';
    // On a full disk the list is not complete, and some file of this run may outlive it.
    if (::ftruncate(descriptor_, 0) != 0) return;
    [[maybe_unused]] const auto written = ::pwrite(descriptor_, text.data(), text.size(), 0);
}

}  // namespace puckloop::tools
