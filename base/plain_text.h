#pragma once
// Text of a user's in a message: on one line, without what a terminal obeys, and no longer than one reads.

#include <cstddef>
#include <exception>
#include <string>
#include <string_view>

namespace puckloop {

/// Control characters (C0, DEL, C1), line and paragraph separators, marks that turn the direction of writing
/// and bytes that are not UTF-8 are shown as escapes: \n, \t, \x1b, \u202e. Of a text longer than `most`
/// bytes the middle is left out and counted: "aaa ... (99,000 bytes left out) ... bbb"; at least 64.
std::string plain_text(std::string_view text, std::size_t most);

/// The same for a message of several lines: a line feed stays.
std::string plain_lines(std::string_view text, std::size_t most);

/// Bytes of a whole message that is shown; what a user gave is cut earlier (base/error.cpp).
inline constexpr std::size_t kLongestMessage = 8192;

/// what(), but of a lack of memory and of what only a damaged file can cause plain words rather than those of
/// a library.
std::string reason_of(const std::exception& error);

}  // namespace puckloop
