#include "gap/extension/learning_rows.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {
constexpr std::size_t kRowsTogether = 60;  // rows that stay together
}  // namespace

void LearningRows::add(const Subject& subject, std::size_t i, bool follows) {
    const bool is_known = std::isfinite(subject.error[i]);
    row.push_back(i);
    starts.push_back(subject.starts[i] != 0 || !follows ? 1 : 0);
    known.push_back(is_known ? 1 : 0);
    error.push_back(is_known ? subject.error[i] : 0.0);
}

LearningRows learning_rows(const Subject& subject, const std::vector<char>& used, std::size_t most) {
    const auto all = static_cast<double>(std::ranges::count(used, 1));
    const double share = std::min(1.0, static_cast<double>(most) / std::max(all, 1.0));
    LearningRows rows;
    std::size_t in_chain = 0, stretches = 0;
    bool taken = false, follows = false;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (subject.starts[i] != 0) in_chain = 0;
        if (in_chain++ % kRowsTogether == 0) {
            const double before = std::floor(static_cast<double>(stretches++) * share);
            taken = std::floor(static_cast<double>(stretches) * share) > before;
        }
        if (!taken || used[i] == 0) {
            follows = false;
            continue;
        }
        rows.add(subject, i, follows);
        follows = true;
    }
    return rows;
}

}  // namespace puckloop::gap
