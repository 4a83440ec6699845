#include "base/error.h"

#include "base/plain_text.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop {

namespace {

// Bytes of each part that are shown: whole paths and lists of what is known, no user's megabyte.
constexpr std::size_t kFile = 1024, kPlace = 256, kProblem = 2048, kExpected = 4096;
// A stretch without a space that is longer is somebody's word, of which so much is shown.
constexpr std::size_t kLongestWord = 300, kShownOfWord = 100;

std::string with_short_words(std::string_view text) {
    std::string shortened;
    while (!text.empty()) {
        const std::size_t size = std::min(text.find(' '), text.size());
        if (size > kLongestWord)
            shortened += plain_text(text.substr(0, size), kShownOfWord);
        else
            shortened += text.substr(0, size);
        text.remove_prefix(size);
        if (text.empty()) break;
        shortened += ' ';
        text.remove_prefix(1);
    }
    return shortened;
}

std::string one_line(std::string_view file, std::string_view place, std::string_view problem,
                     std::string_view expected) {
    std::string text;
    if (!file.empty()) text += fmt::format("{}: ", plain_text(file, kFile));
    if (!place.empty()) text += fmt::format("{}: ", plain_text(place, kPlace));
    text += plain_text(with_short_words(problem), kProblem);
    if (!expected.empty()) text += fmt::format(" (expected {})", plain_text(expected, kExpected));
    return text;
}

}  // namespace

InputError::InputError(std::string_view file, std::string_view place, std::string_view problem,
                       std::string_view expected)
    : std::runtime_error(one_line(file, place, problem, expected)), file_(file), place_(place) {}

}  // namespace puckloop
