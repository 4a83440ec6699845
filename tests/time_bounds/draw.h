#pragma once
// What scenarios are drawn with.

#include "base/random.h"

#include <cstdint>
#include <iterator>
#include <string>

namespace puckloop::tests {

class Draw {
  public:
    Draw(std::uint64_t seed, const char* kind) : random_(seed, std::string("time_bounds/") + kind) {}

    std::uint64_t below(std::uint64_t end) { return random_.below(end); }
    bool one_in(std::uint64_t n) { return random_.below(n) == 0; }
    /// In [least, end).
    double uniform(double least, double end) { return least + (end - least) * random_.uniform(); }
    /// The same, with even shares for each power of ten; 0 < least.
    double logarithmic(double least, double end);
    template <class List>
    auto of(const List& list) {
        return list[random_.below(std::size(list))];
    }
    /// Uniform in [least, end) s, as in a scenario: "1.234567890 s" in quotes.
    std::string time(double least, double end);

  private:
    RandomStream random_;
};

/// In s, to a picosecond, as in a scenario.
std::string quoted_time(double seconds);

}  // namespace puckloop::tests
