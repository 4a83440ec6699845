#include "gap/stats/profile.h"

#include "gap/stats/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::gap::stats {

namespace {

struct Split {
    std::size_t after = 0;  // bins before the step
    double explained = 0;   // share of the bins' variance
    double jump = 0;
};

Split best_split(const std::vector<double>& y) {
    const double total = std::pow(standard_deviation(y), 2) * static_cast<double>(y.size() - 1);
    Split best;
    for (std::size_t k = 1; k < y.size() && total > 0; ++k) {
        const auto cut = y.begin() + static_cast<std::ptrdiff_t>(k);
        const double low = std::accumulate(y.begin(), cut, 0.0) / static_cast<double>(k);
        const double high = std::accumulate(cut, y.end(), 0.0) / static_cast<double>(y.size() - k);
        const double weight = static_cast<double>(k * (y.size() - k)) / static_cast<double>(y.size());
        const double explained = weight * (high - low) * (high - low) / total;
        if (explained > best.explained) best = {k, explained, high - low};
    }
    return best;
}

/// The value of the straight line through the first two (or last two) bins is not asked: the bin nearest to
/// 0.
bool zero_at_zero(const Profile& p) {
    const double reach = std::max(std::fabs(p.x.front()), std::fabs(p.x.back()));
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < p.x.size(); ++i)
        if (std::fabs(p.x[i]) < std::fabs(p.x[nearest])) nearest = i;
    const double at_far = std::max(std::fabs(p.y.front()), std::fabs(p.y.back()));
    const double allowed =
        std::max(0.15 * at_far + 0.5 * at_far * std::fabs(p.x[nearest]) / reach, 2 * p.error[nearest]);
    return reach > 0 && std::fabs(p.x[nearest]) < 0.25 * reach && std::fabs(p.y[nearest]) < allowed;
}

std::string course(const Profile& p, std::string_view covariate, bool rising) {
    const std::size_t middle = p.x.size() / 2;
    const double whole = p.y.back() - p.y.front();
    const double early = (p.y[middle] - p.y.front()) / whole;
    const double early_x = (p.x[middle] - p.x.front()) / (p.x.back() - p.x.front());
    std::string words = fmt::format("{} with {}", rising ? "grows" : "falls", covariate);
    if (early > early_x + 0.3)
        words += fmt::format(", mostly below {}", plain(p.x[middle]));
    else if (early < early_x - 0.3)
        words += fmt::format(", mostly beyond {}", plain(p.x[middle]));
    if (zero_at_zero(p)) words += fmt::format(", zero at {} = 0", covariate);
    return words;
}

}  // namespace

double Profile::range() const {
    if (y.empty()) return 0.0;
    const auto [low, high] = std::ranges::minmax_element(y);
    return *high - *low;
}

std::vector<int> bins_of(const std::vector<double>& x, int& count, int bins, int levels) {
    std::vector<double> sorted = finite(x);
    std::ranges::sort(sorted);
    std::vector<double> edges;  // upper ends of all bins but the last
    std::vector<double> distinct = sorted;
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    if (distinct.size() <= static_cast<std::size_t>(levels)) {
        edges.assign(distinct.begin(), distinct.end() - (distinct.empty() ? 0 : 1));
    } else {
        const std::size_t most = std::max<std::size_t>(sorted.size() / 3, 2);
        const std::size_t wanted = std::min<std::size_t>(static_cast<std::size_t>(bins), most);
        for (std::size_t b = 1; b < wanted; ++b) {
            const double edge = sorted[b * sorted.size() / wanted];
            if (edge < sorted.back() && (edges.empty() || edge > edges.back())) edges.push_back(edge);
        }
    }
    count = static_cast<int>(edges.size()) + 1;
    std::vector<int> bin(x.size(), -1);
    for (std::size_t i = 0; i < x.size(); ++i)
        if (std::isfinite(x[i]))
            bin[i] = static_cast<int>(std::ranges::lower_bound(edges, x[i]) - edges.begin());
    return bin;
}

std::vector<double> means_at(const std::vector<int>& place, int count, const std::vector<double>& values) {
    std::vector<double> sum(static_cast<std::size_t>(count), 0.0), rows = sum;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (place[i] < 0 || std::isnan(values[i])) continue;
        sum[static_cast<std::size_t>(place[i])] += values[i];
        rows[static_cast<std::size_t>(place[i])] += 1;
    }
    for (std::size_t k = 0; k < sum.size(); ++k)
        sum[k] = rows[k] > 0 ? sum[k] / rows[k] : NAN;
    return sum;
}

Profile profile_of(const std::vector<double>& x, const std::vector<double>& y, int bins) {
    int count = 0;
    const std::vector<int> bin = bins_of(x, count, bins);
    Profile profile;
    for (int b = 0; b < count; ++b) {
        std::vector<double> in_x, in_y;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (bin[i] == b) in_x.push_back(x[i]), in_y.push_back(y[i]);
        if (in_x.empty()) continue;
        profile.x.push_back(mean(in_x));
        profile.y.push_back(mean(in_y));
        const double spread = in_y.size() > 1 ? standard_deviation(in_y) : 0.0;
        profile.error.push_back(spread / std::sqrt(static_cast<double>(in_y.size())));
    }
    return profile;
}

std::string shape_words(const Profile& p, std::string_view covariate) {
    if (p.x.size() < 2) return fmt::format("one value of {} only", covariate);
    if (p.range() == 0) return fmt::format("flat over {}", covariate);
    if (p.x.size() == 2)
        return fmt::format("{} at {} {} than at {}", p.y[1] > p.y[0] ? "higher" : "lower", covariate,
                           plain(p.x[1]), plain(p.x[0]));
    const double order = correlation(ranks(p.x), ranks(p.y));
    const double straight = std::pow(correlation(p.x, p.y), 2);
    const Split split = best_split(p.y);
    if (p.x.size() >= 4 && split.explained > 0.93 && straight < 0.88)
        return fmt::format("steps {} near {} {}", split.jump > 0 ? "up" : "down", covariate,
                           plain(0.5 * (p.x[split.after - 1] + p.x[split.after])));
    if (std::fabs(order) > 0.8) return course(p, covariate, order > 0);
    const auto [low, high] = std::ranges::minmax_element(p.y);
    const auto inner = [&](auto at) { return at != p.y.begin() && at + 1 != p.y.end(); };
    const double ends = 0.5 * (p.y.front() + p.y.back());
    const auto at_x = [&](auto at) { return plain(p.x[static_cast<std::size_t>(at - p.y.begin())]); };
    if (inner(high) && *high - ends > 0.6 * p.range())
        return fmt::format("highest near {} {}, lower on both sides", covariate, at_x(high));
    if (inner(low) && ends - *low > 0.6 * p.range())
        return fmt::format("lowest near {} {}, higher on both sides", covariate, at_x(low));
    return fmt::format("uneven over {}: highest near {}, lowest near {}", covariate, at_x(high), at_x(low));
}

std::string plain(double value, int digits) {
    const double size = std::fabs(value);
    if (size != 0 && (size < 1e-4 || size >= 1e7)) return fmt::format("{:.2e}", value);
    return fmt::format("{:.{}g}", value, digits);
}

}  // namespace puckloop::gap::stats
