#pragma once
// A recorded run as one HTML file: page and data together, for any browser, without puckloop and without a
// network.

#include "view/events/read_events.h"
#include "view/recording/recording.h"

#include <cstddef>
#include <string>

namespace puckloop::view {

/// Bytes of cameras' pictures in an exported page; those behind are left out.
inline constexpr std::size_t kMostExportedPictures = 64U << 20;

/// Waits for `events`. Data are compressed (gzip) and in base 64. Throws RunError where the file would be
/// larger than `most` bytes, and what EventReader::wait() throws.
std::string exported_page(const Recording& recording, EventReader& events, std::size_t most = 256U << 20);

/// As RFC 4648 has it, with padding.
std::string base64(std::string_view bytes);
/// gzip; throws RunError.
std::string compressed(std::string_view bytes);

}  // namespace puckloop::view
