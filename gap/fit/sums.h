#pragma once
// How sums that drift begin, and what they gain where their axes turn (walk.h): for what filters them and for
// what makes them.

#include "gap/fit/walk.h"
#include "gap/models/model.h"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <type_traits>

namespace puckloop::gap {

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

}  // namespace puckloop::gap
