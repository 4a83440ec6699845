#pragma once
// A node's log: what a person looks for after a run, one line an event, in order of simulated time.

#include <bit>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace puckloop {

/// Lines "[   17.630123 s] text", each flushed at once, so that a crash keeps it.
class NodeLog {
  public:
    /// Replaces the file; an empty path is no log. Throws RunError naming the file if it cannot be opened.
    explicit NodeLog(std::string path = {});

    /// False without a path, and once a write has failed: nothing needs to be worked out for it.
    bool is_open() const { return file_ != nullptr; }
    /// Throws RunError naming the file when it cannot be written, a full disk say; later lines are dropped.
    void line(double seconds, std::string_view text);

    /// From here on lines are kept back, until settle() writes them or rewind() drops them. A mark set before
    /// is settled. mark() and settle() throw as line() does.
    void mark();
    void rewind() { kept_back_.clear(); }
    void settle();

  private:
    void write(std::string_view lines);

    struct Closer {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::string path_;
    std::unique_ptr<std::FILE, Closer> file_;
    bool marked_ = false;
    std::string kept_back_;
};

/// Is the `count`th event of its kind reported? 1, 2, 4, 8, ...: what goes on for ever stays readable.
constexpr bool is_milestone(std::uint64_t count) {
    return std::has_single_bit(count);
}

}  // namespace puckloop
