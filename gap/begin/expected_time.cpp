#include "gap/begin/expected_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

/// CPU seconds of a thousand rows; measured on made experiments and those of docs/gap.md.
double seconds_per_thousand(Kind kind) {
    return kind == Kind::Motion ? 5.0 : kind == Kind::Rab ? 2.0 : 1.0;
}

constexpr double kGrowth = 0.8;    // large experiments are begun on a part of their rows
constexpr double kParallel = 0.7;  // share of the work that threads divide among them

}  // namespace

double expected_seconds(const Experiment& experiment, unsigned threads) {
    const double cpu = seconds_per_thousand(experiment.kind) *
                       std::pow(static_cast<double>(experiment.rows()) / 1000, kGrowth);
    return cpu * (1 - kParallel + kParallel / std::max(1U, threads));
}

double seconds_left(double expected, double elapsed, double share) {
    const double left = 1 - std::clamp(share, 0.0, 1.0);
    return left * (left * expected + elapsed);
}

std::string rough_time(double seconds) {
    constexpr double kMinute = 60;
    if (seconds < 1) return "about a second";
    if (seconds < 2 * kMinute) return fmt::format("about {:.0f} s", seconds);
    return fmt::format("about {:.0f} min", seconds / kMinute);
}

}  // namespace puckloop::gap
