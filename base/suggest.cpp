#include "base/suggest.h"

#include <algorithm>

namespace puckloop {

namespace {

constexpr std::size_t kLongestName = 64;

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c;
}

}  // namespace

std::size_t edit_distance(std::string_view left, std::string_view right) {
    std::vector<std::size_t> row(right.size() + 1);
    for (std::size_t j = 0; j <= right.size(); ++j)
        row[j] = j;
    for (std::size_t i = 1; i <= left.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= right.size(); ++j) {
            const std::size_t above = row[j];
            const std::size_t replaced = diagonal + (lower(left[i - 1]) != lower(right[j - 1]));
            row[j] = std::min({above + 1, row[j - 1] + 1, replaced});
            diagonal = above;
        }
    }
    return row[right.size()];
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

}  // namespace puckloop
