#include "gap/decide/range_end.h"

#include "gap/decide/thresholds.h"

#include <cmath>
#include <initializer_list>
#include <limits>

namespace puckloop::gap {

double range_end(double value, double low, double high, double neutral) {
    const bool wide = low > 0 && high / low > thresholds::kWideRange;
    const auto scaled = [wide](double one) { return wide ? std::log(one) : one; };
    const double near = thresholds::kRangeEnd * (scaled(high) - scaled(low));
    for (const double end : {low, high}) {
        // Nothing, and all of a share, are ends of what there is, not of what is believed.
        if (end == 0.0 || (end == 1.0 && low == 0.0)) continue;
        const bool beside_neutral = (!wide || neutral > 0) && std::abs(scaled(end) - scaled(neutral)) <= near;
        if (!beside_neutral && !(wide && value <= 0) && std::abs(scaled(value) - scaled(end)) < near)
            return end;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace puckloop::gap
