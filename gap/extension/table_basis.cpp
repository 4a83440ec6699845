#include "gap/extension/table_basis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr double kLeastApart = 0.002;  // of the range: places nearer are one
constexpr double kUnsure = 1e-6;       // added to each value's variance: numerics

struct Axis {
    std::vector<double> at, along;
};

/// All different values where they are few; else those nearest to equal ways.
Axis places_in(std::vector<double> values, std::size_t most) {
    std::ranges::sort(values);
    std::vector<double> different = values;
    different.erase(std::unique(different.begin(), different.end()), different.end());
    Axis axis;
    if (different.size() < 2) return axis;
    const double low = different.front(), range = different.back() - low;
    const auto ways = [&](double value) {
        const auto below = std::ranges::lower_bound(values, value) - values.begin();
        return ((value - low) / range + static_cast<double>(below) / static_cast<double>(values.size())) / 2;
    };
    const auto place = [&](double value) {
        if (!axis.at.empty() && value <= axis.at.back() + kLeastApart * range) return;
        axis.at.push_back(value);
        axis.along.push_back(ways(value));
    };
    std::size_t next = 0;
    for (std::size_t k = 0; k < most; ++k) {
        const double wanted = ways(different.back()) * static_cast<double>(k) / static_cast<double>(most - 1);
        if (different.size() > most)
            while (next + 1 < different.size() && ways(different[next]) < wanted)
                ++next;
        else
            next = k;
        if (next < different.size()) place(different[next]);
    }
    if (axis.at.back() != different.back()) {  // the last places are nearer than they may be
        axis.at.back() = different.back();
        axis.along.back() = ways(different.back());
    }
    for (double& one : axis.along)
        one /= axis.along.back();
    return axis;
}

Axis places_round(std::size_t count) {
    Axis axis;
    for (std::size_t k = 0; k <= count; ++k) {
        axis.along.push_back(static_cast<double>(k) / static_cast<double>(count));
        axis.at.push_back(std::numbers::pi * (2 * axis.along.back() - 1));
    }
    return axis;
}

/// The place above a value, and the share of the way from the one below.
std::pair<std::size_t, double> place_of(const std::vector<double>& at, double wanted) {
    const double value = std::clamp(wanted, at.front(), at.back());
    const auto above = std::clamp<std::size_t>(
        static_cast<std::size_t>(std::ranges::upper_bound(at, value) - at.begin()), 1, at.size() - 1);
    return {above, (value - at[above - 1]) / (at[above] - at[above - 1])};
}

double correlation(double distance, double length) {
    const double scaled = std::sqrt(3.0) * distance / length;
    return (1 + scaled) * std::exp(-scaled);
}

Eigen::MatrixXd covariance(const std::vector<double>& along, bool periodic, double length) {
    const auto n = static_cast<Eigen::Index>(along.size());
    Eigen::MatrixXd all(n, n);
    for (Eigen::Index a = 0; a < n; ++a)
        for (Eigen::Index b = 0; b < n; ++b) {
            const double apart =
                std::abs(along[static_cast<std::size_t>(a)] - along[static_cast<std::size_t>(b)]);
            // Once round an axis of 1: the chord, so that both ends are one.
            const double distance =
                periodic ? std::abs(std::sin(std::numbers::pi * apart)) / std::numbers::pi : apart;
            all(a, b) = correlation(distance, length);
        }
    return all;
}

}  // namespace

const LaidAxis& LaidAxes::axis(std::size_t c, std::size_t most) {
    const auto [place, fresh] = laid_.try_emplace({c, most});
    LaidAxis& laid = place->second;
    if (!fresh) return laid;
    const WorldCovariate& covariate = subject_.covariates[c];
    std::vector<double> values;
    for (std::size_t i = 0; i < used_.size(); ++i)
        for (std::size_t m = subject_.moments[i]; used_[i] != 0 && m < subject_.moments[i + 1]; ++m)
            values.push_back(covariate.value[m]);
    // Where other rows go nothing is known, and the table has to say so.
    const auto [low, high] = std::ranges::minmax(covariate.value);
    values.insert(values.end(), {low, high});
    Axis axis = covariate.periodic ? places_round(most) : places_in(std::move(values), most);
    laid.at = std::move(axis.at);
    laid.along = std::move(axis.along);
    if (laid.at.empty()) return laid;
    for (const double value : covariate.value) {
        const auto [above, share] = place_of(laid.at, value);
        laid.above.push_back(static_cast<std::uint16_t>(above));
        laid.share.push_back(share);
    }
    return laid;
}

TableBasis::TableBasis(LaidAxes& axes, const TableShape& shape, std::size_t most) : shape_(shape) {
    const Subject& subject = axes.subject();
    for (const std::size_t c : shape.over) {
        const LaidAxis& axis = axes.axis(c, most);
        periodic_.push_back(subject.covariates[c].periodic ? 1 : 0);
        values_ *= axis.at.size();
        places_.push_back(axis.at);
        along_.push_back(axis.along);
    }
    if (shape.by_sensor) tables_ = static_cast<std::size_t>(subject.sensors);
    if (shape.by_run && !subject.run.empty()) tables_ = *std::ranges::max_element(subject.run) + 1;
}

std::size_t TableBasis::table_of(const Subject& subject, std::size_t i) const {
    if (shape_.by_run) return subject.run[i];
    return shape_.by_sensor ? static_cast<std::size_t>(subject.sensor[i]) : 0;
}

TableBasis::Found TableBasis::found(const Subject& subject, std::size_t axis, std::size_t m) const {
    const auto [above, share] = place_of(places_[axis], subject.covariates[shape_.over[axis]].value[m]);
    return {above, share};
}

Eigen::MatrixXd TableBasis::root(const Kernel& kernel) const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Ones(1, 1);
    for (std::size_t k = 0; k < places_.size(); ++k) {
        const Eigen::MatrixXd own =
            covariance(along_[k], periodic_[k] != 0 && kernel.round, kernel.lengths[k]);
        Eigen::MatrixXd wider(all.rows() * own.rows(), all.cols() * own.cols());
        for (Eigen::Index a = 0; a < all.rows(); ++a)
            for (Eigen::Index b = 0; b < all.cols(); ++b)
                wider.block(a * own.rows(), b * own.cols(), own.rows(), own.cols()) = all(a, b) * own;
        all = std::move(wider);
    }
    all.diagonal().array() += kUnsure;
    return all.llt().matrixL();
}

}  // namespace puckloop::gap
