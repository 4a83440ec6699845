#include "benchmark/measures/reference.h"

#include <array>
#include <chrono>
#include <cstdint>

namespace puckloop::tools {

double reference_speed(double wall_s) {
    using Clock = std::chrono::steady_clock;
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < table.size(); ++i)
        table[i] = (i * 2654435761u) >> 8;
    constexpr int kBatch = 1'000'000;
    std::uint32_t state = 1;
    double steps = 0, elapsed = 0;
    const auto start = Clock::now();
    do {
        for (int i = 0; i < kBatch; ++i)
            state = (state >> 3) ^ table[state & 0xFFu] ^ static_cast<std::uint32_t>(i);
        steps += kBatch;
        elapsed = std::chrono::duration<double>(Clock::now() - start).count();
    } while (elapsed < wall_s);
    // The result must be wanted, or the compiler would leave the work out.
    volatile std::uint32_t sink = state;
    static_cast<void>(sink);
    return steps / elapsed * 1e-6;
}

}  // namespace puckloop::tools
