#pragma once
// `flash`: an image that a programmer writes into a board's chip (emu/chip/faults/board_faults.h).

#include <string_view>

namespace puckloop::cosim {

inline constexpr std::string_view kFlashKind = "flash";
/// In the results of a run that a client drove, beside events.toml: the images that it flashed, as they were.
inline constexpr std::string_view kFlashedFolder = "flashed";

}  // namespace puckloop::cosim
