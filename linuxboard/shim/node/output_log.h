#pragma once
// The file that a program's standard output and error go to, whose size is bounded. The program writes into
// it without anybody between: a pipe would be waited for, and a file is not.

#include <sys/types.h>

#include <string>

namespace puckloop::linuxboard {

class OutputLog {
  public:
    /// So many bytes of the output are kept.
    static constexpr off_t kMost = off_t{64} << 20;

    /// `file` is made anew; empty: none. Throws InputError.
    explicit OutputLog(const std::string& file);
    /// Cuts the file behind what is kept and appends a line with the number of bytes left out.
    ~OutputLog();
    OutputLog(const OutputLog&) = delete;
    OutputLog& operator=(const OutputLog&) = delete;

    /// -1: no file.
    int descriptor() const { return descriptor_; }
    /// While the program runs: gives back the disk space of what is not kept, but for the last lines. The
    /// size of the file goes on counting what was written.
    void release();

  private:
    int descriptor_ = -1;
    off_t released_ = kMost;  ///< up to here the file has no space on disk behind kMost
};

}  // namespace puckloop::linuxboard
