#include "base/text/suggest.h"

#include <algorithm>
#include <utility>

namespace puckloop {

namespace {

constexpr std::size_t kLongestName = 64;
constexpr std::size_t kMostNames = 3;

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c;
}

/// Does `name` begin or end with `words`, set off by a point or underscore?
bool has_words(std::string_view name, std::string_view words) {
    const auto sets_off = [](char c) { return c == '.' || c == '_'; };
    if (name.size() <= words.size()) return false;
    return (name.starts_with(words) && sets_off(name[words.size()])) ||
           (name.ends_with(words) && sets_off(name[name.size() - words.size() - 1]));
}

}  // namespace

std::size_t edit_distance(std::string_view left, std::string_view right) {
    std::vector<std::size_t> before;  // the row two characters back, for swaps
    std::vector<std::size_t> above(right.size() + 1);
    for (std::size_t j = 0; j <= right.size(); ++j)
        above[j] = j;
    for (std::size_t i = 1; i <= left.size(); ++i) {
        std::vector<std::size_t> row(right.size() + 1);
        row[0] = i;
        for (std::size_t j = 1; j <= right.size(); ++j) {
            const bool same = lower(left[i - 1]) == lower(right[j - 1]);
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (same ? 0 : 1)});
            const bool swapped = i > 1 && j > 1 && lower(left[i - 1]) == lower(right[j - 2]) &&
                                 lower(left[i - 2]) == lower(right[j - 1]);
            if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
        }
        before = std::move(above);
        above = std::move(row);
    }
    return above[right.size()];
}

std::string nearest_name(std::string_view name, const std::vector<std::string_view>& known) {
    if (name.size() > kLongestName) return {};
    std::size_t best_distance = name.size() <= 3 ? 2 : 3;  // one beyond the farthest that counts as near
    std::string best;
    for (const std::string_view candidate : known) {
        if (candidate.size() > kLongestName) continue;
        const std::size_t distance = edit_distance(name, candidate);
        if (distance >= best_distance) continue;
        best_distance = distance;
        best = candidate;
    }
    return best;
}

std::vector<std::string> near_names(std::string_view name, const std::vector<std::string_view>& known) {
    if (name.empty() || name.size() > kLongestName) return {};
    const std::size_t farthest = name.size() <= 3 ? 1 : name.size() <= 10 ? 2 : 3;
    std::size_t best = farthest + 1;  // the distance of whole words
    std::vector<std::string> names;
    for (const std::string_view candidate : known) {
        const std::size_t edits = edit_distance(name, candidate);
        const std::size_t distance = edits > farthest && has_words(candidate, name) ? farthest + 1 : edits;
        if (distance < best) names.clear();
        best = std::min(best, distance);
        const bool fresh = std::find(names.begin(), names.end(), candidate) == names.end();
        if (distance == best && fresh && names.size() < kMostNames) names.emplace_back(candidate);
    }
    return names;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string_view>& known) {
    std::string text;
    const std::vector<std::string> names = near_names(name, known);
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "; did you mean \"" : i + 1 == names.size() ? "\" or \"" : "\", \"") + names[i];
    return text.empty() ? text : text + "\"?";
}

}  // namespace puckloop
