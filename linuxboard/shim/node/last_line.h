#pragma once
// The last thing a program said, for an error message.

#include <string>
#include <string_view>

namespace puckloop::linuxboard {

/// Last line of `output` that shows any text: without escape sequences (colours, cursor movements) and other
/// control characters, and of a line written over with carriage returns what was written last. Empty if there
/// is none.
std::string last_line_with_text(std::string_view output);

}  // namespace puckloop::linuxboard
