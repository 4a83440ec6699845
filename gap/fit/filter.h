#pragma once
// Innovations: what each row says that the rows before it did not.
//
// Deviations: 1. what a clipped row tells the next is taken for normal, with its mean and variance; beside a
// line or in a sum a row after a clipped one counts as the first of a chain. 2. Where a sum may be pushed, a
// few likely histories stand for all.

#include "gap/fit/noise.h"

#include <array>
#include <cstddef>
#include <vector>

namespace puckloop::gap {

enum class RowRole : char {
    Plain,  ///< an innovation
    First,  ///< only says where a short sum begins
    Low,    ///< at or below the instrument's floor
    High,   ///< at or above its ceiling
    Piled,  ///< cut to the prediction's ceiling
    Event,  ///< happened or not
};

struct Innovations {
    /// Plain: standardised innovation. Low, High, Piled: the limit, in sd above the mean. Event: its
    /// probability.
    std::vector<double> z;
    std::vector<double> variance;  ///< Plain: of the innovation, observable's unit squared; else 1
    std::vector<RowRole> role;
    /// A sum that may be pushed: what a plain row costs, but for the density's constant; else empty.
    std::vector<double> mixed;
    /// Of the same: how likely each row was pushed, by what a few rows after it say.
    std::vector<double> pushed;
};

/// A model is never surer than this of a single event or clip.
inline constexpr double kLeastProbability = 1e-3;

/// `gain`: of a Level observable, the share of each innovation that the sum took over; may be null.
void filter(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise,
            Innovations& out, std::vector<double>* gain = nullptr);

/// A sum in which nothing is cut, pushed, or noisier here than there: several predictions of it can be
/// filtered at a time, which takes little longer than one and gives the same numbers.
inline constexpr std::size_t kLanes = 4;
bool is_plain_sum(const Observable& observable, const Predicted& predicted);
void filter_sums(const Observable& observable, const std::array<const Predicted*, kLanes>& predicted,
                 const std::array<NoiseParameters, kLanes>& noise,
                 const std::array<Innovations*, kLanes>& out);

}  // namespace puckloop::gap
