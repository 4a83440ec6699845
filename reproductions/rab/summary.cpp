#include "reproductions/rab/summary.h"

#include "base/quantile.h"
#include "protocols/infrared/rab_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::tools {

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kCentimetres = 100;
constexpr double kSameDistance = 1e-6;  // m

double deviation_of_logarithm(const std::vector<double>& values) {
    double mean = 0.0;
    double square = 0.0;
    for (const double value : values) {
        mean += std::log(value);
        square += std::log(value) * std::log(value);
    }
    const auto n = static_cast<double>(values.size());
    return n > 0 ? std::sqrt(std::max(square / n - mean * mean / (n * n), 0.0)) : 0.0;
}

double root_mean_square(const std::vector<double>& values) {
    double square = 0.0;
    for (const double value : values)
        square += value * value;
    return values.empty() ? 0.0 : std::sqrt(square / static_cast<double>(values.size()));
}

}  // namespace

std::optional<physics::PublishedStrength> published_at(double distance) {
    for (const auto& entry : physics::kPublishedStrengths)
        if (std::abs(entry.distance - distance) < kSameDistance) return entry;
    return std::nullopt;
}

Spread spread_of(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto at = [&values](double share) { return sorted_quantile(values, share); };
    return {at(0.05), at(0.10), at(0.25), at(0.5), at(0.75), at(0.90), at(0.95)};
}

std::vector<RabSummary> summarise(const std::vector<RabReadingRow>& rows,
                                  const std::vector<double>& distances) {
    std::vector<RabSummary> all(distances.size());
    for (std::size_t i = 0; i < distances.size(); ++i)
        all[i].distance = distances[i];
    for (const RabReadingRow& row : rows) {
        RabSummary& s = all[row.distance];
        ++s.sent;
        s.strays += static_cast<std::size_t>(row.strays);
        if (!row.received) continue;
        ++s.received;
        if (row.late) ++s.late;
        if (row.range > 0) s.strengths.push_back(row.range);
        s.bearing_errors.push_back(kDegrees *
                                   std::remainder(row.bearing - row.bearing_true, 2 * std::numbers::pi));
    }
    for (RabSummary& s : all) {
        std::vector<double> estimates;
        for (const double strength : s.strengths)
            estimates.push_back(protocols::rab_distance_cm(strength));
        s.strength = spread_of(s.strengths);
        s.estimate_cm = spread_of(estimates);
        s.bearing_error = spread_of(s.bearing_errors);
        s.sigma = deviation_of_logarithm(s.strengths);
        s.bearing_rms = root_mean_square(s.bearing_errors);
    }
    return all;
}

std::string summary_csv(const std::vector<RabSummary>& summary) {
    std::string csv =
        "distance_cm,sent,received,late,strays,strength_median,strength_sigma_ln,strength_p10,strength_p90,"
        "published_median,published_sigma_ln,estimate_cm_p10,estimate_cm_median,estimate_cm_p90,"
        "bearing_error_deg_p5,bearing_error_deg_p25,bearing_error_deg_median,bearing_error_deg_p75,"
        "bearing_error_deg_p95,bearing_error_deg_rms\n";
    for (const RabSummary& s : summary) {
        csv += fmt::format("{:g},{},{},{},{},{:.0f},{:.3f},{:.0f},{:.0f},", s.distance * kCentimetres, s.sent,
                           s.received, s.late, s.strays, s.strength.median, s.sigma, s.strength.p10,
                           s.strength.p90);
        if (const auto published = published_at(s.distance))
            csv += fmt::format("{:.0f},{:.3f},", std::exp(published->log_median), published->spread);
        else
            csv += ",,";
        const Spread& b = s.bearing_error;
        csv += fmt::format("{:.1f},{:.1f},{:.1f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f}\n",
                           s.estimate_cm.p10, s.estimate_cm.median, s.estimate_cm.p90, b.p5, b.p25, b.median,
                           b.p75, b.p95, s.bearing_rms);
    }
    return csv;
}

std::string summary_text(const std::vector<RabSummary>& summary) {
    std::string text =
        fmt::format("{:>8} {:>11} {:>9} {:>10} {:>9} {:>10} {:>14} {:>13}\n", "distance", "received",
                    "strength", "published", "sigma", "published", "bearing rms", "5 to 95 %");
    for (const RabSummary& s : summary) {
        const auto published = published_at(s.distance);
        text += fmt::format(
            "{:>5g} cm {:>5} of {:<4} {:>8.0f} {:>10} {:>9.3f} {:>10} {:>10.1f} deg {:>6.1f} .. {:.1f}\n",
            s.distance * kCentimetres, s.received, s.sent, s.strength.median,
            published ? fmt::format("{:.0f}", std::exp(published->log_median)) : "", s.sigma,
            published ? fmt::format("{:.3f}", published->spread) : "", s.bearing_rms, s.bearing_error.p5,
            s.bearing_error.p95);
    }
    return text;
}

}  // namespace puckloop::tools
