#pragma once
// What went over a serial line, byte for byte, from the trace of a results folder.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace puckloop::view {

/// JSON of the rows of `link` in the trace from byte `from` of the file on, at most kMostSerialScan bytes of
/// it: "next" (where to go on), "more" (there is more now), "from" (the nodes that sent), and by byte "t"
/// (when it arrived, s), "f" (which of "from"), "v" (its value), "k" (0 arrived, 1 lost, 2 put there by a
/// fault, 3 a break). A file that is not there has none; what is no row is left out.
std::string serial_bytes(const std::filesystem::path& trace, std::string_view link, std::size_t from);

inline constexpr std::size_t kMostSerialScan = 8U << 20;

}  // namespace puckloop::view
