#include "gap/extension/learning_rows.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {
constexpr std::size_t kRowsTogether = 60;  // rows that stay together
}  // namespace

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
        const bool known = std::isfinite(subject.error[i]);
        rows.row.push_back(i);
        rows.starts.push_back(subject.starts[i] != 0 || !follows ? 1 : 0);
        rows.known.push_back(known ? 1 : 0);
        rows.error.push_back(known ? subject.error[i] : 0.0);
        follows = true;
    }
    return rows;
}

}  // namespace puckloop::gap
