#pragma once
// When a fault happens and to which of what comes by: the keys that all kinds of one style share.

#include "cosim/faults/kinds/kind_table.h"
#include "scenarios/values/reader.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace puckloop::scenarios {

/// Window, count, probability or burst, skip and every, as far as the kind takes them.
void read_when(Reader& reader, const cosim::KindInfo& kind, cosim::FaultSpec& fault);
/// bytes, position, match and offset, as far as the kind takes them.
void read_match(Reader& reader, const cosim::KindInfo& kind, cosim::FaultSpec& fault);
/// "0x7F" or "127", the text of `key`.
std::uint8_t byte_of(Reader& reader, std::string_view key, const std::string& text);

}  // namespace puckloop::scenarios
