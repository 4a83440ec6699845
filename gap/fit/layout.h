#pragma once
// Which numbers a fit moves, and where each stands in a solver's vector.

#include "gap/fit/fit.h"

#include <utility>
#include <vector>

namespace puckloop::gap {

/// Freed model parameters first (their distance from the centre in prior widths), then the model's nuisances
/// likewise, then the noise of each observable.
class Layout {
  public:
    Layout(const Model& model, const std::vector<Freed>& freed, const Effort& effort);

    std::size_t size() const { return freed_.size() + noise_.size(); }
    std::size_t freed() const { return freed_.size(); }  ///< nuisances too
    /// Of a number of the noise: whose, and which (as noise_parameter counts).
    std::size_t observable(std::size_t j) const { return noise_[j - freed_.size()].first; }
    int noise_index(std::size_t j) const { return noise_[j - freed_.size()].second; }

    std::vector<double> packed(const State& state) const;
    /// Writes the numbers into `state`; model parameters are kept within their range.
    void unpack(const double* x, State& state) const;
    /// The least and the most that the number may be.
    std::pair<double, double> bounds(std::size_t j) const;
    /// The longest step of this number that a curvature is believed for.
    double longest(std::size_t j) const;

  private:
    const Model& model_;
    std::vector<Freed> freed_;
    std::vector<std::pair<std::size_t, int>> noise_;
};

}  // namespace puckloop::gap
