#include "campaigns/jobs/folder_lock.h"

#include "base/error.h"
#include "base/files/claimed_folder.h"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace puckloop::jobs {

namespace fs = std::filesystem;

namespace {
constexpr const char* kMark = ".campaign";
}

FolderLock::FolderLock(const fs::path& out, const std::vector<std::string>& results) {
    std::error_code error;
    fs::create_directories(out, error);
    if (error)
        throw InputError(out.string(), "", "cannot be made: " + error.message(), "a folder for results");
    refuse_foreign_results(out, kMark, results);
    file_ = ::open((out / kMark).c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (file_ < 0) throw InputError(out.string(), "", std::strerror(errno), "a folder for results");
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
        ::close(file_);
        throw InputError(out.string(), "", "another campaign writes here", "--out with another folder");
    }
    claim_folder(out, kMark, results);
}

FolderLock::~FolderLock() {
    ::close(file_);
}

void remove_folder(const fs::path& path) {
    constexpr int kTries = 50;
    std::error_code error;
    for (int tries = 0; tries < kTries; ++tries) {
        fs::remove_all(path, error);
        if (error != std::errc::directory_not_empty) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    if (error) throw RunError(fmt::format("{}: cannot be removed: {}", path.string(), error.message()));
}

}  // namespace puckloop::jobs
