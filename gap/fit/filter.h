#pragma once
// Innovations: what each row says that the rows before it did not.
//
// Deviations: 1. what a clipped row tells the next is taken for normal, with its mean and variance, and so is
// what a row tells the next that may be a lapse; beside a line or in a sum a row after a clipped one counts
// as the first of a chain. 2. Where a sum may be pushed, a few likely histories stand for all.

#include "gap/fit/noise.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <type_traits>
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
    /// Of the same: how far each row is from where those before it had the sum go on, observable's unit.
    std::vector<double> off;

    /// So many plain rows, their innovations to be written.
    void reset(std::size_t rows);
};

/// Where a sum begins: the median of its first errors, since the very first may be an outlier of a heavy
/// tail. Errors are in the unit of the observable.
struct Beginning {
    double error = 0.0;  ///< of the first row
    double guess = 0.0;  ///< the sum's own part of it
    double rows = 1.0;   ///< that the guess rests on
};

/// Of the chain that begins in row `i`.
Beginning beginning(const Observable& o, const Predicted& p, std::size_t i);

/// Variance that a sum gains where its axes turn, in units of the error's: each error comes in along one axis
/// and leaves along another. Errors that carry over do so together, as long as the axes stay near.
template <class Number>
Number turned_in(const Observable& o, std::size_t i, const Number& memory) {
    if (o.turn.empty()) return Number(memory * 0.0);
    const double squared = o.turn[i] * o.turn[i];
    const Number short_of = 1.0 - memory;
    return squared * (1.0 - memory * memory) / (short_of * short_of + memory * squared);
}

/// Variance of the guess, in units of the error's: that of a median of so many errors that carry over; of one
/// row it is the error's own.
template <class Number>
Number unsure_of(double rows, const Number& memory) {
    if (rows < 2) return Number(memory * 0.0 + 1.0);
    const Number variance = std::numbers::pi / 2 * (1.0 + memory) / ((1.0 - memory) * rows);
    if constexpr (std::is_same_v<Number, double>)
        return std::min(variance, 1.0);
    else
        return variance.min(1.0);
}

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
