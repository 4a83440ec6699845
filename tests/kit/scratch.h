#pragma once
// A place for a test's files that no other test, running at the same time, has.

#include <filesystem>
#include <string>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace puckloop::tests {

/// Removes what a test has left in its places when its process ends.
class ScratchPaths {
  public:
    ScratchPaths() = default;
    ScratchPaths(const ScratchPaths&) = delete;
    ScratchPaths& operator=(const ScratchPaths&) = delete;
    ~ScratchPaths() {
        if (::getpid() != owner_) return;  // a forked child that ends by exit()
        std::error_code ignored;
        for (const auto& path : paths_)
            std::filesystem::remove_all(path, ignored);
    }
    void add(const std::filesystem::path& path) { paths_.push_back(path); }

  private:
    pid_t owner_ = ::getpid();
    std::vector<std::filesystem::path> paths_;
};

/// Not made yet; CTest runs every case in a process of its own, so the process number distinguishes cases.
inline std::filesystem::path scratch_path(const std::string& name) {
    static ScratchPaths paths;
    auto path = std::filesystem::temp_directory_path() / (name + "." + std::to_string(::getpid()));
    paths.add(path);
    return path;
}

}  // namespace puckloop::tests
