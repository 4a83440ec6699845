#include "gap/extension/table_basis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr std::size_t kPlacesOfOne = 12, kPlacesOfTwo = 6;  // along an axis alone, and beside another
constexpr double kLeastApart = 0.01;                        // of the range: places nearer are one
constexpr double kUnsure = 1e-6;                            // added to each value's variance: numerics

/// Where a share of the rows lies below each; all different values where they are few.
std::vector<double> places_in(std::vector<double> values, std::size_t count) {
    std::ranges::sort(values);
    std::vector<double> different = values;
    different.erase(std::unique(different.begin(), different.end()), different.end());
    std::vector<double> wanted;
    if (different.size() <= count)
        wanted = different;
    else
        for (std::size_t k = 0; k < count; ++k)
            wanted.push_back(values[k * (values.size() - 1) / (count - 1)]);
    std::vector<double> places;
    const double apart = wanted.empty() ? 0.0 : kLeastApart * (wanted.back() - wanted.front());
    for (const double one : wanted)
        if (places.empty() || one > places.back() + apart) places.push_back(one);
    if (places.size() > 1) places.back() = wanted.back();
    return places;
}

std::vector<double> places_round(std::size_t count) {
    std::vector<double> places;
    for (std::size_t k = 0; k <= count; ++k)
        places.push_back(std::numbers::pi * (2 * static_cast<double>(k) / static_cast<double>(count) - 1));
    return places;
}

double kernel(double distance, double length) {
    const double scaled = std::sqrt(3.0) * distance / length;
    return (1 + scaled) * std::exp(-scaled);
}

Eigen::MatrixXd covariance(std::size_t places, bool periodic, double length) {
    const auto n = static_cast<Eigen::Index>(places);
    Eigen::MatrixXd all(n, n);
    for (Eigen::Index a = 0; a < n; ++a)
        for (Eigen::Index b = 0; b < n; ++b) {
            const double share =
                static_cast<double>(a - b) / static_cast<double>(std::max<Eigen::Index>(n - 1, 1));
            // Once round an axis of 1: the chord, so that both ends are one.
            const double distance =
                periodic ? std::abs(std::sin(std::numbers::pi * share)) / std::numbers::pi : std::abs(share);
            all(a, b) = kernel(distance, length);
        }
    return all;
}

}  // namespace

TableBasis::TableBasis(const Subject& subject, const TableShape& shape, const std::vector<char>& used)
    : shape_(shape) {
    lay_places(subject, used);
    if (shape.by_sensor) tables_ = static_cast<std::size_t>(subject.sensors);
    if (shape.by_run && !subject.run.empty()) tables_ = *std::ranges::max_element(subject.run) + 1;
}

void TableBasis::lay_places(const Subject& subject, const std::vector<char>& used) {
    for (const std::size_t c : shape_.over) {
        const WorldCovariate& covariate = subject.covariates[c];
        const std::size_t most = shape_.over.size() == 1 ? kPlacesOfOne : kPlacesOfTwo;
        std::vector<double> values;
        for (std::size_t i = 0; i < covariate.value.size(); ++i)
            if (used[i] != 0 && subject.span[i] > 0) values.push_back(covariate.value[i]);
        periodic_.push_back(covariate.periodic ? 1 : 0);
        places_.push_back(covariate.periodic ? places_round(most) : places_in(std::move(values), most));
        values_ *= places_.back().size() < 2 ? 0 : places_.back().size();
    }
}

std::size_t TableBasis::table_of(const Subject& subject, std::size_t i) const {
    if (shape_.by_run) return subject.run[i];
    return shape_.by_sensor ? static_cast<std::size_t>(subject.sensor[i]) : 0;
}

RowWeights TableBasis::row(const Subject& subject, std::size_t i) const {
    RowWeights row;
    double factor = subject.span[i];
    if (shape_.times >= 0) factor *= subject.covariates[static_cast<std::size_t>(shape_.times)].value[i];
    row.weight[0] = factor;
    std::size_t corners = 1;
    for (std::size_t k = 0; k < places_.size(); ++k) {
        const auto& at = places_[k];
        const double value = std::clamp(subject.covariates[shape_.over[k]].value[i], at.front(), at.back());
        const auto above = std::clamp<std::size_t>(
            static_cast<std::size_t>(std::ranges::upper_bound(at, value) - at.begin()), 1, at.size() - 1);
        const double share = (value - at[above - 1]) / (at[above] - at[above - 1]);
        for (std::size_t c = 0; c < corners; ++c) {
            row.at[c + corners] = row.at[c] * at.size() + above;
            row.weight[c + corners] = row.weight[c] * share;
            row.at[c] = row.at[c] * at.size() + above - 1;
            row.weight[c] *= 1 - share;
        }
        corners *= 2;
    }
    return row;
}

Eigen::MatrixXd TableBasis::root(double length) const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Ones(1, 1);
    for (std::size_t k = 0; k < places_.size(); ++k) {
        const Eigen::MatrixXd own = covariance(places_[k].size(), periodic_[k] != 0, length);
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
