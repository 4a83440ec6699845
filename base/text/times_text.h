#pragma once
// "once", "2 times", " (2 times so far)", for messages.

#include <cstdint>
#include <string>

namespace puckloop {

inline std::string times_text(std::uint64_t times) {
    return times == 1 ? "once" : std::to_string(times) + " times";
}

/// For a line that is written now and then of what happens often; empty the first time.
inline std::string so_far_text(std::uint64_t times) {
    return times == 1 ? std::string() : " (" + std::to_string(times) + " times so far)";
}

}  // namespace puckloop
