#pragma once
// The Linux board as a machine, for whoever asks for more than its clocks.

#include <cstdint>

namespace puckloop::shim {

/// Bytes of main memory: 512 MiB, as the Gumstix Overo of the robot's extension board has.
inline constexpr std::uint64_t kBoardMemory = std::uint64_t{512} << 20;

/// Since the board started, by its own clock.
std::uint64_t up_nanoseconds();
/// Of the program.
unsigned processes_alive();

}  // namespace puckloop::shim
