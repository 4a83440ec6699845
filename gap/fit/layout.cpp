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

std::vector<double> Layout::packed(const State& state) const {
    std::vector<double> x;
    for (const Freed& one : freed_)
        x.push_back((state.values[one.index] - one.centre) / one.prior_sd);
    for (const auto& [observable, index] : noise_) {
        NoiseParameters copy = state.noise[observable];
        x.push_back(noise_parameter(copy, index));
    }
    return x;
}

void Layout::unpack(const double* x, State& state) const {
    for (const Freed& one : freed_)
        state.values[one.index] = std::clamp(one.centre + *x++ * one.prior_sd, one.low, one.high);
    for (const auto& [observable, index] : noise_)
        noise_parameter(state.noise[observable], index) = *x++;
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
