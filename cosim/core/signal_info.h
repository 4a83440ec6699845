#pragma once
// A board's named signals: one list serves the bench, the physics world and the tests. A Signal message's id
// is an index into the list of the board at whose port it travels.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace puckloop::cosim {

/// Seen from the board: an Input is set by the world or a stimulus, an Output is driven by the firmware.
enum class SignalDirection : std::uint8_t { Input, Output };

struct SignalInfo {
    std::string name;
    SignalDirection direction = SignalDirection::Input;
    std::string unit;  ///< "counts", "V", "steps", "level", ...
    double min = 0.0;
    double max = 1.0;
    std::string description;
    double initial = 0.0;  ///< value until somebody sets it
};

/// Index of `name` in `signals`, or nothing.
inline std::optional<std::uint16_t> find_signal(std::span<const SignalInfo> signals, std::string_view name) {
    for (std::size_t i = 0; i < signals.size(); ++i)
        if (signals[i].name == name) return static_cast<std::uint16_t>(i);
    return std::nullopt;
}

}  // namespace puckloop::cosim
