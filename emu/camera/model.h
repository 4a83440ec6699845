#pragma once
// The camera models that a main board may carry, and what their registers mean.
// Source: e-puck fact sheet 3.12 and the settings that the e-puck library's camera drivers write.

#include "emu/camera/video_mode.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace puckloop::camera {

enum class Model : std::uint8_t { Po3030k, Po6030k, Po8030d };

/// "po3030k", "po6030k", "po8030d".
std::string_view name_of(Model model);
std::optional<Model> model_of(std::string_view name);

/// 256 registers a bank; the PO3030K has one bank, the others four, chosen by register 3.
inline constexpr std::size_t kBanks = 4, kBankSize = 256;
using Registers = std::array<std::uint8_t, kBanks * kBankSize>;

inline constexpr std::uint8_t kI2cAddress = 0x6E;  ///< 7 bits, of all

Registers po3030k_defaults();
VideoMode po3030k_mode(const Registers& registers);
Registers po6030k_defaults();
VideoMode po6030k_mode(const Registers& registers);
Registers po8030d_defaults();
VideoMode po8030d_mode(const Registers& registers);

/// After a reset.
Registers defaults_of(Model model);

/// What the model's registers come to, with frames no shorter than the array needs.
VideoMode mode_of(Model model, const Registers& registers);

}  // namespace puckloop::camera
