#include "gap/fit/layout.h"

#include <algorithm>

namespace puckloop::gap {

namespace {
constexpr double kLongestWidths = 4.0;  // of a prior
constexpr double kLongestLog = 1.5;     // of a noise parameter that is a logarithm
constexpr double kLongestShare = 0.3;   // of one that is a share
}  // namespace

Layout::Layout(const Model& model, const std::vector<Freed>& freed, const Effort& effort)
    : model_(model), freed_(freed) {
    const auto left = [&](bool wanders) { return !effort.noise || (wanders && !effort.wander); };
    for (const Nuisance& one : model.nuisances())
        if (!left(one.wanders))
            freed_.push_back(
                {one.index, one.low, one.high, one.prior_sd, model.parameters()[one.index].neutral});
    for (std::size_t o = 0; o < model.observables().size(); ++o)
        for (int k = 0; k < noise_parameters(model.observables()[o]); ++k)
            if (k == 0 || !left(k == 1 && model.observables()[o].noise == NoiseKind::Level))
                noise_.emplace_back(o, k);
}

void Layout::pack(const State& state, double* x) const {
    for (std::size_t j = 0; j < freed_.size(); ++j)
        x[j] =
            (state.values[static_cast<std::size_t>(freed_[j].index)] - freed_[j].centre) / freed_[j].prior_sd;
    for (std::size_t k = 0; k < noise_.size(); ++k) {
        NoiseParameters copy = state.noise[noise_[k].first];
        x[freed_.size() + k] = noise_parameter(copy, noise_[k].second);
    }
}

void Layout::unpack(const double* x, State& state) const {
    for (std::size_t j = 0; j < freed_.size(); ++j)
        state.values[static_cast<std::size_t>(freed_[j].index)] =
            std::clamp(freed_[j].centre + x[j] * freed_[j].prior_sd, freed_[j].low, freed_[j].high);
    for (std::size_t k = 0; k < noise_.size(); ++k)
        noise_parameter(state.noise[noise_[k].first], noise_[k].second) = x[freed_.size() + k];
}

std::pair<double, double> Layout::bounds(std::size_t j) const {
    if (j >= freed_.size()) return noise_bounds(model_.observables()[observable(j)].noise, noise_index(j));
    const Freed& one = freed_[j];
    return {(one.low - one.centre) / one.prior_sd, (one.high - one.centre) / one.prior_sd};
}

double Layout::longest(std::size_t j) const {
    if (j < freed_.size()) return kLongestWidths;
    const bool drift = noise_index(j) == 1 && model_.observables()[observable(j)].noise == NoiseKind::Level;
    return drift || noise_index(j) == 0 || noise_index(j) == 2 ? kLongestLog : kLongestShare;
}

}  // namespace puckloop::gap
