#pragma once
// Bad input, reported once and in one shape: which file, where in it, what is wrong, what was expected.

#include <stdexcept>
#include <string>
#include <string_view>

namespace puckloop {

/// Thrown for anything the user gave that cannot be used: an image, a scenario, an option, a recorded file.
/// The command line prints what() on one line and exits with status 2.
class InputError : public std::runtime_error {
  public:
    /// `file` may be empty (an option, say); `place` is "line 7", "offset 0x1c" or empty; `expected` may be
    /// empty.
    InputError(std::string_view file, std::string_view place, std::string_view problem,
               std::string_view expected = {});

    const std::string& file() const { return file_; }
    const std::string& place() const { return place_; }

  private:
    std::string file_;
    std::string place_;
};

/// Thrown when a run that began well cannot go on: a node process died or stalled, the disk is full.
/// The command line prints what() on one line, keeps what was recorded and exits with status 1.
class RunError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace puckloop
