#include "run/report/alike_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string_view>

namespace puckloop::tools {

namespace {

struct Range {
    std::uint64_t least = 0, most = 0;
};

/// A text word by word; a word that is a whole number is empty here, and is in `numbers` by its place.
struct Counted {
    std::vector<std::string> words;
    std::map<std::size_t, Range> numbers;
};

Counted counted(std::string_view text) {
    Counted found;
    while (true) {
        const std::size_t end = text.find(' ');
        const std::string_view word = text.substr(0, end);
        std::uint64_t number = 0;
        const auto [after, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        const bool whole = error == std::errc{} && after == word.data() + word.size() &&
                           (word.front() != '0' || word.size() == 1);
        if (whole) found.numbers[found.words.size()] = {number, number};
        found.words.emplace_back(whole ? std::string_view() : word);
        if (end == std::string_view::npos) return found;
        text.remove_prefix(end + 1);
    }
}

bool alike(const Counted& a, const Counted& b) {
    const auto same_place = [](const auto& one, const auto& other) { return one.first == other.first; };
    return a.words == b.words &&
           std::equal(a.numbers.begin(), a.numbers.end(), b.numbers.begin(), b.numbers.end(), same_place);
}

std::string text_of(const Counted& counted) {
    std::string text;
    for (std::size_t place = 0; place < counted.words.size(); ++place) {
        if (place > 0) text += ' ';
        const auto number = counted.numbers.find(place);
        if (number == counted.numbers.end()) {
            text += counted.words[place];
            continue;
        }
        const auto [least, most] = number->second;
        text += least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
    }
    return text;
}

std::string_view kind_of(std::string_view node) {
    return node.substr(node.rfind('.') + 1);
}

}  // namespace

std::vector<std::string> alike_as_one(const std::vector<std::string>& warnings) {
    struct Line {
        std::string node;
        Counted text;
        std::size_t count = 1;
    };
    std::vector<Line> lines;
    for (const std::string& warning : warnings) {
        const std::size_t colon = warning.find(": ");
        const std::string node = colon == std::string::npos ? "" : warning.substr(0, colon);
        const Counted text = counted(colon == std::string::npos ? warning : warning.substr(colon));
        const auto same = std::find_if(lines.begin(), lines.end(), [&](const Line& line) {
            return !node.empty() && alike(line.text, text) && kind_of(line.node) == kind_of(node);
        });
        if (same == lines.end()) {
            lines.push_back({node, text});
            continue;
        }
        ++same->count;
        for (const auto& [place, number] : text.numbers) {
            Range& range = same->text.numbers[place];
            range.least = std::min(range.least, number.least);
            range.most = std::max(range.most, number.most);
        }
    }
    std::vector<std::string> shown;
    for (const Line& line : lines)
        shown.push_back(line.count == 1
                            ? line.node + text_of(line.text)
                            : fmt::format("{} and {} more{}", line.node, line.count - 1, text_of(line.text)));
    return shown;
}

}  // namespace puckloop::tools
