#include "gap/fit/objective.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kRelativeStep = 2e-5;  // of a prior's width, for differences
constexpr double kNoiseStep = 1e-5;
constexpr double kClaimDoubt = 0.08;  // of ln sd, where the simulator claims one
constexpr double kLeastCurvature = 1e-8;
constexpr int kTail = 2;  // as noise_parameter counts

Eigen::Index as_index(std::size_t i) {
    return static_cast<Eigen::Index>(i);
}

}  // namespace

double claim_error(const Observable& observable, const NoiseParameters& noise) {
    if (observable.known_sd <= 0) return 0.0;
    const double nu = std::exp(noise.log_tail);
    const double sd = noise.log_sd + 0.5 * std::log(nu / std::max(nu - 2, 0.5));
    return (sd - std::log(observable.known_sd)) / kClaimDoubt;
}

Objective::Objective(const Model& model, const Layout& layout, State base, const Weights& weights)
    : model_(model),
      layout_(layout),
      state_(std::move(base)),
      weights_(weights),
      bases_(model.observables().size()),
      columns_(bases_.size()) {}

double Objective::fill(std::size_t o) {
    Base& base = bases_[o];
    const Observable& observable = model_.observables()[o];
    static const std::vector<double> even;
    const bool known = observable.fixed_sd > 0;  // few parameters move it
    if (known && base.filled == prediction_[o]) return base.sum;
    filter(observable, prediction_[o], state_.noise[o], base.innovations);
    if (known) base.filled = prediction_[o];
    return base.sum = cost_sum(observable, prediction_[o], state_.noise[o], base.innovations,
                               weights_.empty() ? even : weights_[o]);
}

double Objective::priors(const double* x) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < layout_.freed(); ++j)
        sum += prior_cost(x[j]);
    for (std::size_t o = 0; o < bases_.size(); ++o) {
        const double off = claim_error(model_.observables()[o], state_.noise[o]);
        sum += off * off / 2;
    }
    return sum;
}

double Objective::value(const double* x) {
    layout_.unpack(x, state_);
    std::vector<double> here(x, x + layout_.size());
    if (!last_x_.empty() && here == last_x_) return last_value_;
    last_x_ = std::move(here);
    model_.predict(state_.values, prediction_);
    double sum = priors(x);
    for (std::size_t o = 0; o < bases_.size(); ++o)
        sum += fill(o);
    return last_value_ = sum;
}

/// A column for each; at most kLanes.
void Objective::take_differences(std::size_t o, const std::vector<Moved>& moved) {
    if (moved.empty()) return;
    const Observable& observable = model_.observables()[o];
    const bool together = moved.size() > 1 && std::ranges::all_of(moved, [&](const Moved& one) {
                              return is_plain_sum(observable, *one.predicted);
                          });
    if (together) {
        std::array<const Predicted*, kLanes> predicted{};
        std::array<NoiseParameters, kLanes> noise;
        std::array<Innovations*, kLanes> out{};
        for (std::size_t k = 0; k < kLanes; ++k) {
            const Moved& one = moved[std::min(k, moved.size() - 1)];  // the last one fills up
            predicted[k] = one.predicted;
            noise[k] = one.noise;
            out[k] = &other_[k];
        }
        filter_sums(observable, predicted, noise, out);
    }
    for (std::size_t k = 0; k < moved.size(); ++k) {
        if (!together) filter(observable, *moved[k].predicted, moved[k].noise, other_[k]);
        difference(o, moved[k], other_[k]);
    }
}

void Objective::difference(std::size_t o, const Moved& moved, const Innovations& other) {
    const Observable& observable = model_.observables()[o];
    Base& base = bases_[o];
    Column& column = columns_[o].emplace_back();
    column.number = moved.number;
    const bool simple = is_simple(*moved.predicted) && is_simple(prediction_[o]);
    if (!simple) {
        costs_of(observable, *moved.predicted, moved.noise, other, other_cost_);
        if (base.cost.empty())
            costs_of(observable, prediction_[o], base_noise_[o], base.innovations, base.cost);
    }
    const std::size_t n = observable.y.size();
    for (Eigen::VectorXd* one : {&column.shift, &column.scale, &column.gradient})
        one->resize(as_index(n));
    column.other.resize(simple ? 0 : as_index(n));
    column.scales = other.variance != base.innovations.variance;
    if (!column.scales) column.scale.setZero();
    for (std::size_t i = 0; i < n; ++i) {
        const auto k = as_index(i);
        const double dz = (other.z[i] - base.innovations.z[i]) / moved.step;
        column.shift[k] = dz;
        column.gradient[k] = base.rows.slope[i] * dz + (moved.tail ? base.rows.tail[i] : 0.0);
        if (column.scales) {
            const double variance = base.innovations.variance[i];
            const double change = other.variance[i] - variance;
            const double scale = change == 0.0 ? 0.0 : change / (2 * variance * moved.step);
            column.scale[k] = scale;
            column.shift[k] += base.innovations.z[i] * scale;
            column.gradient[k] += scale;
        }
        if (simple) continue;
        const double whole = (other_cost_[i] - base.cost[i]) / moved.step;
        column.other[k] = whole - column.gradient[k];
        column.gradient[k] = whole;
    }
}

/// Adds one observable's part.
void Objective::gather(std::size_t o, Eigen::VectorXd& gradient, Eigen::MatrixXd& curvature) const {
    const Base& base = bases_[o];
    const auto n = as_index(base.rows.slope.size()), width = as_index(columns_[o].size());
    if (width == 0) return;
    Eigen::VectorXd weights(n), bend(n);
    for (std::size_t i = 0; i < base.rows.slope.size(); ++i) {
        weights[as_index(i)] = weight(o, i);
        bend[as_index(i)] = std::sqrt(weight(o, i) * base.rows.curvature[i]);
    }
    if (!base.innovations.mixed.empty()) {
        gather_mixed(o, weights, gradient, curvature);
        return;
    }
    const ScaleInformation information = scale_information(state_.noise[o]);
    Eigen::MatrixXd shifts(n, width), scales = Eigen::MatrixXd::Zero(n, width), others;
    bool any_scale = false;
    double plain = 0.0;
    for (std::size_t i = 0; i < base.rows.slope.size(); ++i)
        if (base.innovations.role[i] == RowRole::Plain) plain += weight(o, i);
    std::vector<Eigen::Index> at;  // place of each column
    for (const Column& column : columns_[o]) {
        const auto a = as_index(at.size());
        at.push_back(as_index(column.number));
        shifts.col(a) = column.shift.cwiseProduct(bend);
        if (column.scales) scales.col(a) = column.scale.cwiseProduct(weights.cwiseSqrt());
        any_scale = any_scale || column.scales;
        gradient[at.back()] += column.gradient.dot(weights);
        if (column.other.size() == 0) continue;
        if (others.size() == 0) others = Eigen::MatrixXd::Zero(n, width);
        others.col(a) = column.other.cwiseProduct(weights.cwiseSqrt());
    }
    Eigen::MatrixXd part = Eigen::MatrixXd::Zero(width, width);
    part.selfadjointView<Eigen::Lower>().rankUpdate(shifts.transpose());
    if (any_scale) part.selfadjointView<Eigen::Lower>().rankUpdate(scales.transpose(), information.scale);
    if (others.size() > 0) part.selfadjointView<Eigen::Lower>().rankUpdate(others.transpose());
    curvature(at, at) += Eigen::MatrixXd(part.selfadjointView<Eigen::Lower>());
    for (const Eigen::Index tail : at) {
        const auto number = static_cast<std::size_t>(tail);
        if (number < layout_.freed() || layout_.noise_index(number) != kTail) continue;
        curvature(tail, tail) += information.tail * plain;
        for (const Column& column : columns_[o]) {
            if (!column.scales) continue;
            const double both = information.both * column.scale.dot(weights);
            curvature(tail, as_index(column.number)) += both;
            curvature(as_index(column.number), tail) += both;
        }
    }
}

/// Of a sum that may have been pushed the innovation is a mean over histories: what moves it and what moves
/// their weights pull against each other, and squares of both would count a push many times. There each row's
/// own gradient is its information (the outer product: Berndt, Hall, Hall and Hausman 1974).
void Objective::gather_mixed(std::size_t o, const Eigen::VectorXd& weights, Eigen::VectorXd& gradient,
                             Eigen::MatrixXd& curvature) const {
    for (std::size_t a = 0; a < columns_[o].size(); ++a) {
        const Column& one = columns_[o][a];
        gradient[as_index(one.number)] += one.gradient.dot(weights);
        for (std::size_t b = 0; b <= a; ++b) {
            const Column& other = columns_[o][b];
            const double both = one.gradient.cwiseProduct(weights).dot(other.gradient);
            curvature(as_index(one.number), as_index(other.number)) += both;
            if (a != b) curvature(as_index(other.number), as_index(one.number)) += both;
        }
    }
}

double Objective::slopes(const double* x, Eigen::VectorXd& gradient, Eigen::MatrixXd& curvature,
                         Eigen::MatrixXd* rows) {
    double sum = value(x);
    base_noise_ = state_.noise;
    const std::size_t width = layout_.size();
    gradient = Eigen::VectorXd::Zero(as_index(width));
    curvature = kLeastCurvature * Eigen::MatrixXd::Identity(as_index(width), as_index(width));
    if (!std::isfinite(sum)) return sum;
    for (std::size_t o = 0; o < bases_.size(); ++o) {
        Base& base = bases_[o];
        base.cost.clear();
        slopes_of(model_.observables()[o], state_.noise[o], base.innovations, base.rows);
        columns_[o].clear();
    }
    std::vector<double> near(x, x + width);
    const auto move = [&](std::size_t j, double by) {
        const double step = x[j] + by > layout_.bounds(j).second ? -by : by;
        near[j] = x[j] + step;
        layout_.unpack(near.data(), state_);
        near[j] = x[j];
        return step;
    };
    std::vector<Moved> group;
    for (std::size_t first = 0; first < layout_.freed(); first += kLanes) {
        const std::size_t count = std::min(kLanes, layout_.freed() - first);
        std::array<double, kLanes> step{};
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t j = first + k;
            step[k] = move(j, kRelativeStep);
            model_.predict(state_.values, moved_[k]);
            gradient[as_index(j)] += prior_slope(x[j]);
            curvature(as_index(j), as_index(j)) += prior_curvature(x[j]);
        }
        for (std::size_t o = 0; o < bases_.size(); ++o) {
            group.clear();
            for (std::size_t k = 0; k < count; ++k)
                if (moved_[k][o] != prediction_[o])
                    group.push_back({first + k, &moved_[k][o], state_.noise[o], step[k], false});
            take_differences(o, group);
        }
    }
    group.clear();
    for (std::size_t j = layout_.freed(); j < width; ++j) {
        const std::size_t o = layout_.observable(j);
        const double step = move(j, kNoiseStep);
        group.push_back({j, &prediction_[o], state_.noise[o], step, layout_.noise_index(j) == kTail});
        const double claimed = claim_error(model_.observables()[o], state_.noise[o]);
        layout_.unpack(x, state_);
        const double off = claim_error(model_.observables()[o], state_.noise[o]);
        const double slope = (claimed - off) / step;
        gradient[as_index(j)] += off * slope;
        curvature(as_index(j), as_index(j)) += slope * slope;
        if (j + 1 < width && layout_.observable(j + 1) == o && group.size() < kLanes) continue;
        take_differences(o, group);
        group.clear();
    }
    layout_.unpack(x, state_);
    for (std::size_t o = 0; o < bases_.size(); ++o)
        gather(o, gradient, curvature);
    if (rows == nullptr) return sum;
    Eigen::Index first = 0, all = 0;
    for (const Base& base : bases_)
        all += as_index(base.rows.slope.size());
    *rows = Eigen::MatrixXd::Zero(all, as_index(width));
    for (std::size_t o = 0; o < bases_.size(); ++o) {
        const auto n = as_index(bases_[o].rows.slope.size());
        for (const Column& column : columns_[o])
            rows->col(as_index(column.number)).segment(first, n) = column.gradient;
        first += n;
    }
    return sum;
}

}  // namespace puckloop::gap
