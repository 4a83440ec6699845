#pragma once
// "once", "2 times", for messages.

#include <cstdint>
#include <string>

namespace puckloop {

inline std::string times_text(std::uint64_t times) {
    return times == 1 ? "once" : std::to_string(times) + " times";
}

}  // namespace puckloop
