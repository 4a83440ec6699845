#pragma once
// Sums that drift: a random walk seen with carried-over errors, and the same where something may have pushed.
// Variances in units of the error's.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace puckloop::gap {

inline constexpr double kLeastWalkVariance = 1e-9;

/// How far an innovation is believed, by its square in variances. An outlier of a heavy tail says little
/// about the sum (smooth, so that the likelihood is).
inline double trust_in(double squared, double tail) {
    return squared > 1 ? (tail + 1) / (tail + squared) : 1.0;
}
template <class Lanes>
Lanes trust_in(const Lanes& squared, const Lanes& tail) {
    return (squared > 1.0).select((tail + 1.0) / (tail + squared), Lanes::Ones());
}
inline double at_least(double value, double least) {
    return std::max(value, least);
}
template <class Lanes>
Lanes at_least(const Lanes& value, double least) {
    return value.max(least);
}

/// A number that a chain does not know and that acts on its rows in proportion to a lever, learnt on the way.
/// The lever goes through the same filter as the rows do, so that what is left of it is what is new in it.
template <class Number>
struct LeverOf {
    Number level, error, mean, variance;

    void begin(const Number& first, const Number& doubt) {
        level = first;
        error = first * 0.0;
        mean = error;
        variance = doubt;
    }
};

/// Random walk plus carried-over measurement error. `Number`: double, or an Eigen array of walks side by
/// side.
template <class Number>
struct WalkOf {
    Number level, error, p00, p01, p11;

    /// The first row: level and error are known together, and the level for itself with variance `unsure`.
    void begin(const Number& value, const Number& guess, const Number& unsure) {
        level = guess;
        error = value - guess;
        p00 = unsure;
        p01 = -unsure;
        p11 = unsure;
    }

    /// Returns the innovation's variance. `tail`: degrees of freedom of the errors' Student t.
    Number filter(const Number& value, const Number& drift, const Number& memory, const Number& tail,
                  Number& innovation) {
        const Number own = foresee(drift, memory);
        innovation = value - level - error;
        learn(innovation, own, trust_in(Number(innovation * innovation / own), tail));
        return own;
    }

    /// The same beside a lever, `arm` in this row.
    Number filter(const Number& value, const Number& arm, LeverOf<Number>& lever, const Number& drift,
                  const Number& memory, const Number& tail, Number& innovation) {
        const Number own = foresee(drift, memory);
        lever.error *= memory;
        const Number news = arm - lever.level - lever.error, raw = value - level - error;
        innovation = raw - lever.mean * news;
        const Number total = own + lever.variance * news * news;
        const Number trust = trust_in(Number(innovation * innovation / total), tail);
        const Number pull = trust * lever.variance * news / total;
        lever.mean += pull * innovation;
        lever.variance -= pull * news * lever.variance;
        const Number gain = learn(raw, own, trust);
        lever.level += gain * news;
        lever.error += (1.0 - gain) * news;
        return total;
    }

  private:
    /// Returns the variance of what comes.
    Number foresee(const Number& drift, const Number& memory) {
        p00 += drift;
        p01 *= memory;
        p11 = memory * memory * p11 + 1.0 - memory * memory;
        error *= memory;
        return at_least(Number(p00 + 2.0 * p01 + p11), kLeastWalkVariance);
    }

    /// Sum and error together are seen exactly. What is not believed of the sum is an error, and carried over
    /// as errors are. Returns the share that the sum took.
    Number learn(const Number& innovation, const Number& total, const Number& trust) {
        const Number gain = trust * (p00 + p01) / total;
        level += gain * innovation;
        error += (1.0 - gain) * innovation;
        p00 -= gain * (p00 + p01);
        p11 = p00;
        p01 = -p00;
        return gain;
    }
};
using Walk = WalkOf<double>;
using Lever = LeverOf<double>;

/// What a sum may be: it goes on, or something pushed it by an unknown amount in one of the last rows. Each
/// history is a Walk with a weight; the likely ones are kept.
class PushedWalk {
  public:
    struct Row {
        double cost;        ///< minus ln density, without the density's constant
        double innovation;  ///< standardised, the mean over histories
        double off;         ///< from where the row before had it go on, the mean over histories
    };

    /// `lever`: null where nothing acts on the rows by one.
    void begin(double value, double guess, double unsure, const Lever* lever);
    /// How likely a row was pushed, and by how much: mean and variance.
    struct Push {
        double chance, mean, variance;
    };
    /// The rest as Walk::filter.
    Row filter(double value, double arm, double drift, double memory, double tail, const Push& push);
    /// How likely the row `back` rows ago (fewer than 32) was pushed, as seen from the last one.
    double pushed(unsigned back) const;

  private:
    static constexpr std::size_t kHistories = 5;
    struct History {
        Walk walk;
        Lever lever;
        double weight;
        std::uint32_t pushed;  ///< a bit for each of the last rows, the last one lowest
    };
    std::array<History, kHistories> kept_{};  ///< the likeliest first
    std::array<History, 2 * kHistories> next_{};
    std::size_t count_ = 0;
    bool levered_ = false;
    double tail_ = 0.0, normal_ = 1.0;  ///< degrees of freedom, and a normal law's constant over theirs
};

}  // namespace puckloop::gap
