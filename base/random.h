#pragma once
// Seeded random streams, one for each use. The algorithm is fixed here, so that a seed means the same
// numbers on every machine and with every standard library.

#include <array>
#include <cstdint>
#include <string_view>

namespace puckloop {

/// xoshiro256** 1.0 (Blackman and Vigna), seeded through splitmix64 from the run's seed and the stream's
/// name. Streams with different names are independent; drawing from one never shifts another.
class RandomStream {
  public:
    RandomStream(std::uint64_t seed, std::string_view name);

    std::uint64_t next();                  ///< 64 uniform bits
    double uniform();                      ///< [0, 1), 53 bits
    double normal();                       ///< mean 0, standard deviation 1 (polar method, both values used)
    std::uint64_t below(std::uint64_t n);  ///< uniform in [0, n), n > 0, without modulo bias

    /// The position in the stream (base/states/archive.h).
    template <class Archive>
    void state(Archive& archive) {
        archive(state_, spare_, has_spare_);
    }

  private:
    std::array<std::uint64_t, 4> state_;
    double spare_ = 0.0;
    bool has_spare_ = false;
};

}  // namespace puckloop
