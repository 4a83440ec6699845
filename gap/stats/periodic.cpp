#include "gap/stats/exchange.h"
#include "gap/stats/profile.h"
#include "gap/stats/robust.h"
#include "gap/stats/tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap::stats {

namespace {

constexpr std::size_t kSegmentRows = 512;
constexpr std::size_t kSegments = 8;
constexpr std::size_t kLeastRows = 24;
constexpr std::size_t kNeighbours = 12;  // lines on either side that tell a line's background

struct Segment {
    std::vector<double> time, value;
};

/// Stretches of at most kSegmentRows finite rows, spread over the runs; rows whitened by their own lag-1
/// model.
std::vector<Segment> segments_of(const Series& residual, const std::vector<double>& time) {
    std::vector<Segment> all;
    const Pairs known = known_pairs(residual, time);
    const auto cut = [](const std::vector<double>& values, std::size_t first, std::size_t last) {
        return std::vector<double>(values.data() + first, values.data() + last);
    };
    for (const Stretch& s :
         stretches_of(known.group, [&](std::size_t i) { return known.x[i] <= known.x[i - 1]; }))
        for (std::size_t first = s.first; first + kLeastRows <= s.last; first += kSegmentRows) {
            const std::size_t last = std::min(first + kSegmentRows, s.last);
            all.push_back({cut(known.x, first, last), cut(known.y, first, last)});
        }
    std::vector<Segment> chosen;
    const std::size_t step = std::max<std::size_t>((all.size() + kSegments - 1) / kSegments, 1);
    for (std::size_t i = 0; i < all.size(); i += step)
        chosen.push_back(std::move(all[i]));
    for (Segment& s : chosen) {
        s.value = pulled_in(residual, s.value);
        const double centre = mean(s.value);
        for (double& v : s.value)
            v -= centre;
        const double carry = autocorrelation({s.value, std::vector<int>(s.value.size(), 0)}, 1).front();
        for (std::size_t i = s.value.size(); i-- > 1;)
            s.value[i] -= carry * s.value[i - 1];
    }
    return chosen;
}

/// Lomb-Scargle powers of all segments on one grid of frequencies, summed.
class Spectrum {
  public:
    explicit Spectrum(const std::vector<Segment>& segments) {
        std::vector<double> spans, steps;
        for (const Segment& s : segments) {
            spans.push_back(s.time.back() - s.time.front());
            for (std::size_t i = 1; i < s.time.size(); ++i)
                steps.push_back(s.time[i] - s.time[i - 1]);
        }
        step_ = median(steps);
        const double highest = 0.5 / step_, spacing = 1 / median(spans);
        const auto count = static_cast<std::size_t>(highest / spacing);
        for (std::size_t k = 2; k <= std::min(count, kSegmentRows / 2); ++k)
            frequency_.push_back(static_cast<double>(k) * spacing);
        for (const Segment& s : segments)
            add_waves(s.time);
    }

    const std::vector<double>& frequency() const { return frequency_; }
    double step() const { return step_; }

    std::vector<double> power(const std::vector<Segment>& segments) const {
        std::vector<double> sum(frequency_.size(), 0.0);
        std::size_t at = 0;
        for (const Segment& s : segments) {
            const std::size_t n = s.value.size();
            for (double& total : sum) {
                double c = 0, q = 0;
                for (std::size_t i = 0; i < n; ++i)
                    c += s.value[i] * wave_[at + i], q += s.value[i] * wave_[at + n + i];
                total += c * c + q * q;
                at += 2 * n;
            }
        }
        return sum;
    }

  private:
    /// Cosine and sine of unit length for each frequency, orthogonal by Lomb's time shift.
    void add_waves(const std::vector<double>& time) {
        for (const double f : frequency_) {
            const double omega = 2 * std::numbers::pi * f;
            double s2 = 0, c2 = 0;
            for (const double t : time)
                s2 += std::sin(2 * omega * t), c2 += std::cos(2 * omega * t);
            const double shift = std::atan2(s2, c2) / (2 * omega);
            double cc = 0, ss = 0;
            for (const double t : time)
                cc += std::pow(std::cos(omega * (t - shift)), 2);
            ss = static_cast<double>(time.size()) - cc;
            for (const double t : time)
                wave_.push_back(std::cos(omega * (t - shift)) / std::sqrt(std::max(cc, 1e-9)));
            for (const double t : time)
                wave_.push_back(std::sin(omega * (t - shift)) / std::sqrt(std::max(ss, 1e-9)));
        }
    }

    double step_ = 1.0;
    std::vector<double> frequency_, wave_;
};

/// Highest ratio of a line to the median of its neighbours.
double highest_line(const std::vector<double>& power, std::size_t& where) {
    double best = 0;
    std::vector<double> around;
    for (std::size_t k = 0; k < power.size(); ++k) {
        around.clear();
        const std::size_t first = k > kNeighbours ? k - kNeighbours : 0;
        for (std::size_t i = first; i < std::min(power.size(), k + kNeighbours + 1); ++i)
            if (i != k) around.push_back(power[i]);
        const double background = around.empty() ? 0.0 : upper_median(around);
        if (background > 0 && power[k] / background > best) best = power[k] / background, where = k;
    }
    return best;
}

/// Amplitude of the sine at `frequency` in the residual as it is, over all its rows.
double amplitude_at(const Series& residual, const std::vector<double>& time, double frequency) {
    const Pairs known = known_pairs(residual, time);
    double sum = 0;
    for (const Stretch& s : runs_of(known.group)) {
        double c = 0, q = 0, total = 0;
        for (std::size_t i = s.first; i < s.last; ++i)
            total += known.y[i];
        const auto n = static_cast<double>(s.size());
        for (std::size_t i = s.first; i < s.last; ++i) {
            const double phase = 2 * std::numbers::pi * frequency * known.x[i];
            c += (known.y[i] - total / n) * std::cos(phase);
            q += (known.y[i] - total / n) * std::sin(phase);
        }
        sum += 4 * (c * c + q * q) / n;
    }
    return known.size() > 0 ? std::sqrt(sum / static_cast<double>(known.size())) : 0.0;
}

}  // namespace

Finding periodic_test(const Series& residual, const std::vector<double>& time, const TestOptions& options) {
    Finding finding{.test = "periodic", .covariate = "time"};
    std::vector<Segment> segments = segments_of(residual, time);
    double rows = 0;
    for (const Segment& s : segments)
        rows += static_cast<double>(s.value.size());
    if (segments.empty()) return not_asked(finding, "no stretch of 24 rows with rising time");
    const Spectrum spectrum(segments);
    std::size_t where = 0, ignored = 0;
    const double highest = highest_line(spectrum.power(segments), where);
    if (spectrum.frequency().size() < 4 || highest == 0) return not_asked(finding, "too few frequencies");
    const auto draw = [&](RandomStream& random) {
        for (Segment& s : segments)
            shuffle(std::span(s.value), random);
        return highest_line(spectrum.power(segments), ignored);
    };
    finding.p = null_p(highest, rows, draw, options, "periodic");
    const double frequency = spectrum.frequency()[where];
    finding.effect = amplitude_at(residual, time, frequency);
    finding.relative = beside_scatter(finding.effect, residual);
    finding.shape = fmt::format("oscillates at {} Hz (period of {} rows)", plain(frequency),
                                plain(1 / (frequency * spectrum.step())));
    return finding;
}

}  // namespace puckloop::gap::stats
