#include "gap/stats/rate.h"

#include <boost/math/distributions/binomial.hpp>
#include <fmt/format.h>

namespace puckloop::gap {

Rate rate_of(int hits, int of) {
    using Binomial = boost::math::binomial_distribution<>;
    constexpr double kSide = 0.025;
    Rate rate{hits, of};
    if (of == 0) return rate;
    rate.low = hits == 0 ? 0.0 : Binomial::find_lower_bound_on_p(of, hits, kSide);
    rate.high = hits == of ? 1.0 : Binomial::find_upper_bound_on_p(of, hits, kSide);
    return rate;
}

std::string share_text(const Rate& rate) {
    if (rate.of == 0) return "no case";
    return fmt::format("{:.0f} % ({:.0f} to {:.0f}; {} of {})", 100 * rate.share(), 100 * rate.low,
                       100 * rate.high, rate.hits, rate.of);
}

}  // namespace puckloop::gap
