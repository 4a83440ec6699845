#pragma once
// Exception entry as far as others need its figures: what the processor stacks, and when the service routine
// begins. Source: dsPIC30F Family Reference Manual, sections 6 (interrupt latency) and 2 (stack).

#include "emu/dspic/machine/core_state.h"

#include <cstdint>

namespace puckloop::dspic {

/// Bytes that an exception pushes: PC<15:0>, then SR<7:0>, IPL3 and PC<22:16>.
inline constexpr std::uint16_t kExceptionFrame = 4;
/// CORCON<IPL3> in the second word.
inline constexpr std::uint16_t kStackedIpl3 = 0x80;
/// PC<22:16> in the second word, of exceptions and calls alike.
inline constexpr std::uint16_t kStackedPcHigh = 0x7F;

inline constexpr std::uint16_t stacked_pc_low(std::uint32_t pc) {
    return static_cast<std::uint16_t>(pc);
}
inline constexpr std::uint16_t stacked_status(std::uint16_t sr, std::uint16_t corcon, std::uint32_t pc) {
    return static_cast<std::uint16_t>((sr & 0xFFu) << 8 | (corcon & corcon::IPL3 ? kStackedIpl3 : 0u) |
                                      (pc >> 16 & kStackedPcHigh));
}
/// The program address in a stacked pair of words; bit 0 does not exist.
inline constexpr std::uint32_t stacked_pc(std::uint16_t low, std::uint16_t high) {
    return (high & std::uint32_t{kStackedPcHigh}) << 16 | (low & 0xFFFEu);
}

inline constexpr Cycle kServiceLatency = 5, kEntryOverhead = 4, kShortestEntry = 2;

/// First cycle of the service routine of an exception entered between instructions at cycle `now`, its flag
/// set at cycle `since`: five cycles after the flag; at least four after an instruction that ran on for
/// longer than three of them.
inline constexpr Cycle service_start(Cycle since, Cycle now) {
    const Cycle start = since + kServiceLatency;
    return start < now + kShortestEntry ? now + kEntryOverhead : start;
}
/// The same in Doze, where `ratio` cycles are one of the CPU; `since` lies in a CPU cycle before `now`'s.
inline constexpr Cycle service_start(Cycle since, Cycle now, Cycle ratio) {
    return now + ratio * (service_start(0, (now - since) / ratio) - (now - since) / ratio);
}

}  // namespace puckloop::dspic
