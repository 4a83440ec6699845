#include "campaigns/statistics/friedman.h"

#include "campaigns/statistics/distributions.h"
#include "campaigns/statistics/ranks.h"

namespace puckloop::statistics {

Friedman friedman(const std::vector<std::vector<double>>& blocks) {
    Friedman test;
    test.blocks = blocks.size();
    if (blocks.empty()) return test;
    const std::size_t treatments = blocks[0].size();
    test.mean_ranks.assign(treatments, 0.0);
    double ties = 0.0;
    for (const std::vector<double>& block : blocks) {
        const std::vector<double> ranks = midranks(block);
        for (std::size_t i = 0; i < treatments; ++i)
            test.mean_ranks[i] += ranks[i];
        ties += tie_sum(block);
    }
    if (treatments < 2 || blocks.size() < 2) return test;
    const auto n = static_cast<double>(blocks.size()), k = static_cast<double>(treatments);
    double squares = 0.0;
    for (double& sum : test.mean_ranks) {
        squares += (sum - n * (k + 1) / 2) * (sum - n * (k + 1) / 2);
        sum /= n;
    }
    test.freedom = treatments - 1;
    const double scale = n * k * (k + 1) - ties / (k - 1);
    if (!(scale > 0.0)) return test;
    test.chi_square = 12.0 * squares / scale;
    test.p = chi_square_above(test.chi_square, k - 1);
    return test;
}

}  // namespace puckloop::statistics
