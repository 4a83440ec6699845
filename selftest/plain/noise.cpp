#include "selftest/plain/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace puckloop::gap::selftest {

namespace {

constexpr int kStudentFreedom = 5;
constexpr double kOutlierShare = 0.02;
constexpr double kOutlierFactor = 5.0;

/// Columns that may lose single cells: what was measured.
constexpr std::array<std::string_view, 11> kMeasured{
    "reading", "level", "x_m",      "y_m",         "theta_rad",      "ax",
    "ay",      "az",    "strength", "bearing_rad", "ambient_reading"};

bool measured(const std::string& name) {
    return std::find(kMeasured.begin(), kMeasured.end(), name) != kMeasured.end();
}

}  // namespace

NoiseStyle NoiseStyle::draw(RandomStream& random) {
    NoiseStyle style;
    constexpr std::array tails{Tail::Normal, Tail::Student, Tail::Outliers};
    constexpr std::array memories{0.0, 0.4, 0.8};
    constexpr std::array rows{0.0, 0.01, 0.05};
    style.tail = tails[random.below(tails.size())];
    style.memory = memories[random.below(memories.size())];
    style.missing_rows = rows[random.below(rows.size())];
    style.missing_cells = rows[random.below(rows.size())] / 2;
    return style;
}

NoiseSeries::NoiseSeries(const NoiseStyle& style, double sd, RandomStream random)
    : style_(style), sd_(sd), random_(random) {}

double NoiseSeries::innovation() {
    const double normal = random_.normal();
    switch (style_.tail) {
    case NoiseStyle::Tail::Student: {
        double chi = 0.0;
        for (int k = 0; k < kStudentFreedom; ++k) {
            const double n = random_.normal();
            chi += n * n;
        }
        return normal * std::sqrt((kStudentFreedom - 2.0) / chi);
    }
    case NoiseStyle::Tail::Outliers: {
        const double whole = std::sqrt(1.0 - kOutlierShare + kOutlierShare * kOutlierFactor * kOutlierFactor);
        return normal * (random_.uniform() < kOutlierShare ? kOutlierFactor : 1.0) / whole;
    }
    default:
        return normal;
    }
}

double NoiseSeries::next() {
    const double fresh = innovation();
    last_ = started_ ? style_.memory * last_ + std::sqrt(1.0 - style_.memory * style_.memory) * fresh : fresh;
    started_ = true;
    return sd_ * last_;
}

double quantised(double value, double quantum) {
    return quantum > 0.0 ? std::round(value / quantum) * quantum : value;
}

void punch_holes(WrittenRun& run, const NoiseStyle& style, bool keep_rows, RandomStream& random) {
    const std::size_t rows = run.rows();
    std::vector<bool> keep(rows, true);
    for (std::size_t r = 1; r + 1 < rows; ++r)
        keep[r] = random.uniform() >= style.missing_rows;
    for (WrittenColumn& column : run.columns) {
        std::vector<double> left;
        const bool holes = measured(column.name);
        for (std::size_t r = 0; r < rows; ++r) {
            const bool empty =
                holes && ((r > 0 && random.uniform() < style.missing_cells) || (keep_rows && !keep[r]));
            if (keep[r] || keep_rows)
                left.push_back(empty ? std::numeric_limits<double>::quiet_NaN() : column.values[r]);
        }
        column.values = std::move(left);
    }
}

}  // namespace puckloop::gap::selftest
