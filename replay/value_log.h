#pragma once
// Changes of values in the order of time, kept in a nameless file: there may be a hundred million of them.

#include "cosim/core/time.h"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>

namespace puckloop::tools {

struct ValueChange {
    cosim::Time time = 0;
    std::uint64_t value = 0;
    std::uint64_t which = 0;
};

class ValueLog {
  public:
    /// Throws RunError if there is no room for a file.
    ValueLog();

    /// Throws RunError (a full disk).
    void add(const ValueChange& change);
    std::uint64_t size() const { return size_; }
    /// Back to the first change, for next().
    void rewind();
    std::optional<ValueChange> next();

  private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::unique_ptr<std::FILE, Close> file_;
    std::uint64_t size_ = 0;
};

}  // namespace puckloop::tools
