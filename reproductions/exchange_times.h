#pragma once
// How long exchanges by Bluetooth took and how often they failed, beside what was published (Couceiro et al.,
// Robotics and Autonomous Systems 62, 2014).

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

struct ExchangeTimes {
    std::size_t attempts = 0;
    std::size_t not_found = 0;     ///< nobody in the inquiry
    std::size_t failed_later = 0;  ///< no name, no link, no answer
    std::vector<double> totals{};  ///< of those that arrived, s, rising once summarised
    double mean = 0.0, sd = 0.0;   ///< of them
    double standard_error = 0.0;   ///< of the mean

    std::size_t failures() const { return not_found + failed_later; }
    double failed_percent() const;
    /// The total below which this share of them lies; 0 without any.
    double quantile(double share) const;
};

inline constexpr double kPublishedMean = 19.8, kPublishedSd = 4.5;  // s
inline constexpr std::size_t kPublishedAttempts = 58, kPublishedNotFound = 5;

/// Sorts the totals and computes mean and deviation.
void summarise(ExchangeTimes& times);

/// Wilson's interval of a share, 95 %.
struct Interval {
    double low = 0.0, high = 0.0;
};
Interval share_interval(std::size_t part, std::size_t whole);

/// A table of three columns: what, `times`, published. `name` heads the second.
std::string exchange_table(const ExchangeTimes& times, std::string_view name);
/// A histogram of the totals with the published mean and deviation, as SVG.
std::string exchange_picture(const ExchangeTimes& times, std::string_view name);

}  // namespace puckloop::tools
