#pragma once
// How fast the core emulates: figures for `puckloop bench`.

#include <cstdint>
#include <string>

namespace puckloop::dspic {

struct CoreBenchResult {
    std::uint64_t instructions = 0;  ///< executed, not skipped: busy-wait skipping is off
    std::uint64_t cycles = 0;
    double wall_s = 0;
    double instructions_per_second() const {
        return wall_s > 0 ? static_cast<double>(instructions) / wall_s : 0;
    }
};

/// A compute loop in RAM and registers (a CRC, a dot product and a table walk) for about `wall_s` seconds.
CoreBenchResult bench_compute_loop(double wall_s);

/// A real image on a bare dsPIC30F6014A with idle pins, every cycle executed, for about `wall_s` seconds;
/// with `skip_idle` busy waits are skipped and the figure counts the skipped instructions too. Throws
/// InputError if the image cannot be read.
CoreBenchResult bench_image(const std::string& path, double wall_s, bool skip_idle = false);

}  // namespace puckloop::dspic
