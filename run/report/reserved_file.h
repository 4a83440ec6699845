#pragma once
// A file whose space on disk is taken before the run, so that the report can be written when the disk is
// full.

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace puckloop::tools {

class ReservedFile {
  public:
    /// Takes `bytes` under the name `path`.part; of a disk that has less, a quarter of what is free.
    ReservedFile(std::filesystem::path path, std::size_t bytes);
    /// Removes the .part file if write() was not called.
    ~ReservedFile();
    ReservedFile(const ReservedFile&) = delete;
    ReservedFile& operator=(const ReservedFile&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Writes `text` and gives the file its name: it is there whole, or not at all. Throws RunError.
    void write(std::string_view text);

  private:
    [[noreturn]] void fail() const;

    std::filesystem::path path_;
    std::filesystem::path part_;
    int descriptor_ = -1;
};

}  // namespace puckloop::tools
