#include "gap/stats/series.h"

#include "gap/stats/exchange.h"
#include "gap/stats/robust.h"

namespace puckloop::gap::stats {

namespace {

/// Values with each run's own mean taken off; NaN becomes 0, which adds nothing to any product.
std::vector<double> centred(const Series& series) {
    std::vector<double> result(series.size(), 0.0);
    for (const Stretch& s : runs_of(series.run)) {
        double sum = 0;
        std::size_t count = 0;
        for (std::size_t i = s.first; i < s.last; ++i)
            if (std::isfinite(series.value[i])) sum += series.value[i], ++count;
        if (count == 0) continue;
        for (std::size_t i = s.first; i < s.last; ++i)
            if (std::isfinite(series.value[i]))
                result[i] = series.value[i] - sum / static_cast<double>(count);
    }
    return result;
}

/// Rows of the longest run; 0 without any.
std::size_t longest_run(const std::vector<int>& run) {
    std::size_t longest = 0;
    for (const Stretch& s : runs_of(run))
        longest = std::max(longest, s.size());
    return longest;
}

}  // namespace

void Range::take(const std::vector<double>& values) {
    for (const double value : values)
        if (!std::isnan(value)) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
}

bool varies(const std::vector<double>& values) {
    double first = NAN;
    for (const double v : values) {
        if (!std::isfinite(v)) continue;
        if (std::isfinite(first) && v != first) return true;
        first = v;
    }
    return false;
}

std::vector<double> pulled_in(const Series& series, const std::vector<double>& values) {
    return series.events ? values : winsorised(values);
}

std::vector<double> steps_of(const std::vector<double>& values) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < values.size(); ++i)
        if (const double step = values[i] - values[i - 1]; !std::isnan(step)) steps.push_back(step);
    return steps;
}

std::vector<Stretch> runs_of(const std::vector<int>& run) {
    return stretches_of(run);
}

std::vector<double> autocorrelation(const Series& series, std::size_t longest) {
    const std::vector<double> x = centred(series);
    const std::vector<Stretch> runs = runs_of(series.run);
    double power = 0;
    for (const double v : x)
        power += v * v;
    std::vector<double> result(longest, 0.0);
    if (!(power > 0)) return result;
    for (std::size_t lag = 1; lag <= longest; ++lag) {
        double sum = 0;
        for (const Stretch& s : runs)
            for (std::size_t i = s.first; i + lag < s.last; ++i)
                sum += x[i] * x[i + lag];
        result[lag - 1] = sum / power;
    }
    return result;
}

double correlation_length(const Series& series) {
    const std::size_t rows = longest_run(series.run);
    if (rows < 4) return 1.0;
    const std::size_t longest = std::min<std::size_t>(rows / 3, 400);
    const double noise = 2.0 / std::sqrt(static_cast<double>(series.size()));
    double sum = 0;
    for (const double r : autocorrelation(series, longest)) {
        if (r < noise) break;
        sum += r;
    }
    return 1.0 + 2.0 * sum;
}

std::size_t block_length(const Series& series) {
    const double correlated = correlation_length(series);
    if (correlated < 1.2) return 1;  // white as far as its own noise tells
    const auto wanted = static_cast<std::size_t>(std::ceil(2.5 * correlated));
    return std::clamp<std::size_t>(wanted, 1, std::max<std::size_t>(longest_run(series.run) / 3, 1));
}

std::vector<Stretch> blocks_of(const std::vector<int>& run, std::size_t length) {
    std::vector<Stretch> blocks;
    for (const Stretch& s : runs_of(run)) {
        const std::size_t count = std::max<std::size_t>((s.size() + length / 2) / length, 1);
        for (std::size_t b = 0; b < count; ++b) {
            const std::size_t first = s.first + b * length;
            blocks.push_back({first, b + 1 == count ? s.last : first + length, s.run});
        }
    }
    return blocks;
}

}  // namespace puckloop::gap::stats
