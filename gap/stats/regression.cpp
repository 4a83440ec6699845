#include "gap/stats/regression.h"

#include "gap/stats/robust.h"

#include <cmath>

namespace puckloop::gap::stats {

Line clustered_line(const Pairs& pairs) {
    Line line;
    const double n = static_cast<double>(pairs.size());
    const double mean_x = mean(pairs.x), mean_y = mean(pairs.y);
    double square = 0, cross = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        square += (pairs.x[i] - mean_x) * (pairs.x[i] - mean_x);
        cross += (pairs.x[i] - mean_x) * (pairs.y[i] - mean_y);
    }
    line.clusters = static_cast<double>(pairs.blocks.size());
    line.intercept = mean_y;
    if (!(square > 0)) return line;
    line.slope = cross / square;
    line.intercept = mean_y - line.slope * mean_x;
    double slope_variance = 0, intercept_variance = 0;
    for (const Stretch& block : pairs.blocks) {
        double slope_part = 0, intercept_part = 0;
        for (std::size_t i = block.first; i < block.last; ++i) {
            const double rest = pairs.y[i] - line.intercept - line.slope * pairs.x[i];
            slope_part += (pairs.x[i] - mean_x) * rest / square;
            intercept_part += rest * (1 / n - mean_x * (pairs.x[i] - mean_x) / square);
        }
        slope_variance += slope_part * slope_part;
        intercept_variance += intercept_part * intercept_part;
    }
    const double few = line.clusters > 2 ? line.clusters / (line.clusters - 2) : 1.0;  // small-sample factor
    line.slope_error = std::sqrt(few * slope_variance);
    line.intercept_error = std::sqrt(few * intercept_variance);
    return line;
}

}  // namespace puckloop::gap::stats
