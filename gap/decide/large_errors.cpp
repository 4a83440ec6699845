#include "gap/decide/large_errors.h"

#include "gap/fit/filter.h"

#include <boost/math/distributions/students_t.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr int kSteps = 60;                // of expectation maximisation; it settles within some ten
constexpr double kFewest = 1e-3;          // share of larger errors
constexpr double kMost = 0.3;             // beyond, they are not the few
constexpr double kLeastFactor = 1.5;      // by which they are larger
constexpr double kBegun[] = {0.02, 4.0};  // share and factor, at first

double normal_density(double z, double sd) {
    return std::exp(-z * z / (2 * sd * sd)) / (sd * std::sqrt(2 * std::numbers::pi));
}

struct Law {
    double share = kBegun[0], sd = 1.0, factor = kBegun[1];

    double density(double z) const {
        return (1 - share) * normal_density(z, sd) + share * normal_density(z, sd * factor);
    }
};

struct Row {
    double z, log_before;  ///< standardised innovation; its log density by Student's t
    std::uint32_t block;
};

Law fitted_without(const std::vector<Row>& rows, std::uint32_t block) {
    Law law;
    for (int step = 0; step < kSteps; ++step) {
        double large = 0.0, large_squares = 0.0, squares = 0.0, n = 0.0;
        for (const Row& row : rows) {
            if (row.block == block) continue;
            const double wide = law.share * normal_density(row.z, law.sd * law.factor);
            const double all = law.density(row.z);
            const double chance = all > 0 ? wide / all : 1.0;
            large += chance;
            large_squares += chance * row.z * row.z;
            squares += (1 - chance) * row.z * row.z;
            n += 1;
        }
        if (!(n > large) || !(large > 0)) break;
        law.share = std::clamp(large / n, kFewest, kMost);
        law.sd = std::sqrt(squares / (n - large));
        law.factor = std::max(std::sqrt(large_squares / large) / law.sd, kLeastFactor);
    }
    return law;
}

std::vector<Row> rows_of(const Observable& o, const Predicted& predicted, const NoiseParameters& noise,
                         const std::vector<std::uint32_t>& blocks) {
    Innovations innovations;
    filter(o, predicted, noise, innovations);
    std::vector<Row> rows;
    if (!innovations.mixed.empty()) return rows;
    const boost::math::students_t t(std::exp(noise.log_tail));
    for (std::size_t i = 0; i < innovations.z.size(); ++i)
        if (innovations.role[i] == RowRole::Plain)
            rows.push_back({innovations.z[i], std::log(boost::math::pdf(t, innovations.z[i])), blocks[i]});
    return rows;
}

}  // namespace

std::vector<double> gains_of_large_errors(const Study& study, const Fit& fit,
                                          const std::vector<std::string>& touched) {
    std::vector<double> gains(study.blocks().count, 0.0);
    const State& state = fit.fitted.state;
    Prediction prediction;
    study.model().predict(state.values, prediction);
    for (std::size_t o = 0; o < prediction.size(); ++o) {
        const Observable& observable = study.model().observables()[o];
        if (std::find(touched.begin(), touched.end(), observable.name) == touched.end()) continue;
        const auto rows = rows_of(observable, prediction[o], state.noise[o], study.blocks().of[o]);
        for (std::uint32_t block = 0; block < gains.size(); ++block) {
            const Law law = fitted_without(rows, block);
            for (const Row& row : rows)
                if (row.block == block) gains[block] += std::log(law.density(row.z)) - row.log_before;
        }
    }
    return gains;
}

}  // namespace puckloop::gap
