#pragma once
// A results folder that one campaign or experiment writes at a time.

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::jobs {

/// Makes the folder and locks it; the lock ends with the process. InputError where that cannot be, or where
/// the folder has files under the names of `results` that no campaign or experiment wrote.
class FolderLock {
  public:
    FolderLock(const std::filesystem::path& out, const std::vector<std::string>& results);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

  private:
    int file_ = -1;
};

/// Removes it. Workers that were killed a moment ago may still write there: it is tried for 5 s. RunError.
void remove_folder(const std::filesystem::path& path);

}  // namespace puckloop::jobs
