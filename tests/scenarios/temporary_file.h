#pragma once
// A file that lives as long as the test.

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace puckloop::scenarios {

class TemporaryFile {
  public:
    explicit TemporaryFile(const std::string& content)
        : path_(std::filesystem::temp_directory_path() / ("puckloop_scenario_" + std::to_string(::getpid()) +
                                                          "_" + std::to_string(next_++) + ".toml")) {
        std::ofstream(path_) << content;
    }
    ~TemporaryFile() { std::filesystem::remove(path_); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    std::string path() const { return path_.string(); }

  private:
    inline static int next_ = 0;
    std::filesystem::path path_;
};

}  // namespace puckloop::scenarios
