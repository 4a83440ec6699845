#pragma once
// What a fuzz target is: a parser that is given bytes. Run by driver.cpp, which mutates seeds with any
// compiler, or by libFuzzer (clang++, -DPUCKLOOP_LIBFUZZER=ON).

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

namespace puckloop::fuzz {

using Input = std::span<const std::uint8_t>;

/// Each target's file defines it. A refusal of the parser is its own exception type and is caught there; what
/// else is thrown ends the program.
void run_input(Input input);

inline std::string_view text_of(Input input) {
    return {reinterpret_cast<const char*>(input.data()), input.size()};
}

/// Ends the program where `holds` is false: what is read must keep to it.
inline void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "ERROR: %s\n", what);
    std::abort();
}

/// A refusal is one line that names the file.
inline void require_refusal(std::string_view message, std::string_view file) {
    require(!message.empty() && message.find('\n') == std::string_view::npos, "a refusal of one line");
    require(message.find(file) != std::string_view::npos, "a refusal that names the file");
}

/// The input as a file that parsers of files can open.
class InputFile {
  public:
    explicit InputFile(Input input);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;
    const std::string& path() const { return path_; }

  private:
    int descriptor_ = -1;
    std::string path_;
};

}  // namespace puckloop::fuzz
