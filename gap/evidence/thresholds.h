#pragma once
// Every number that the selection and the decision rest on, and why it is what it is. Nothing here is keyed
// on an effect. Numbers that only say how much is computed (candidates looked at again, bins, steps) stand
// where they are used.

#include <cstddef>

namespace puckloop::gap::thresholds {

/// Chance at which anything is named where nothing is wrong; the usual one.
inline constexpr double kFalseAlarm = 0.05;

/// Standard errors by which a held-out gain must stand above nothing: one-sided 5 % of the normal
/// distribution, so that the 90 % interval of the gain excludes zero wherever a gain is claimed.
inline constexpr double kStandardErrors = 1.645;

/// Of all that is gained (named causes, and what corrections without a mechanism gain beside them): a cause
/// that leaves more is not the cause. One fifth: a cause that explains four fifths of what is wrong is worth
/// having in the simulator whatever the rest is.
inline constexpr double kShareLeft = 0.2;
/// Of sums (ways, headings, clocks) one half: what a single row lacks goes on in all rows after it, so that a
/// correction of the rest predicts as much again as a cause that stops short of it.
inline constexpr double kShareLeftOfSums = 0.5;

/// Of events, of what is left and what causes know beyond one chance for all rows (which any cause gains over
/// a simulator that loses nothing): a cause that knows less of which events happen than is left is not the
/// cause.
inline constexpr double kShareLeftOfEvents = 0.5;

/// Corrected p of a structure worth reporting, and of one that alone makes "no effect" untrue. With some
/// hundred structures corrected together (Holm) a tail is carried on from 299 permutations by three moments,
/// which is good to a factor of ten at best: of 252 experiments with nothing hidden six had a p below 1e-4,
/// down to 1e-10, three of them an alternation that rounding makes. Five times as many are drawn near the
/// bounds since (stats/exchange.h): one of 240 was a false alarm. So 1e-4 holds by count what it should, and
/// not one in ten thousand as the figure says.
inline constexpr double kReported = 0.01;
inline constexpr double kSure = 1e-4;
/// The same of a random walk of what should not wander: exp(-gain) is a bound only where errors follow their
/// law. Of some hundred drives with nothing hidden that were looked at three had a p between 6e-6 and 7e-5;
/// of unknown effects of strength 1 and above it is below 1e-8 where a walk shows at all.
inline constexpr double kSureWalk = 1e-7;

/// Of what a cause gains that moves means: at least this much must come from the means it moves, the rest
/// may come from the scatter that goes with them. Half: else it is scatter by another name.
inline constexpr double kMeanShare = 0.5;

/// Of the pushes that a fit counts: at least this part must lie in rows that were more likely pushed than
/// not. Half: else it does not show where it was pushed. And corrected p below which pushes keep to
/// something.
inline constexpr double kPushesShown = 0.5, kPushesByChance = 1e-3;

/// A sum whose own noise is less than this part of its rounding is not asked row by row: what rows say is
/// what the rounding says (a step of q has a sd of 0.29 q, which then is all there is).
inline constexpr double kFineNoise = 0.25;

/// Runs below which stretches of one run are held out, which share its day and place.
inline constexpr std::size_t kRunsThatJudge = 3;
/// Runs below which there are no two halves to confirm on: each half needs two runs to be judged by.
inline constexpr std::size_t kRunsToConfirm = 4;

/// Of the step that readings keep to: an effect that moves them by less, where it acts, does not differ from
/// how they became whole. Half a step, by which readings lie low that are cut off (a firmware's integer
/// division) and not rounded, and 1 / sqrt(12), the sd of rounding itself.
inline constexpr double kRounding = 0.5 + 0.2887;

/// Of a number's prior width: the standard deviation that the data leave it, at most, to be known by them.
/// The whole of it: a number known no better than it was believed is not measured, whatever the likelihood
/// gains.
inline constexpr double kNarrower = 1.0;

// Selection. BIC screens, what decides is the held-out score (gap/evidence/criterion.h).

/// Better by BIC at all: worth the held-out look.
inline constexpr double kScreen = 0.0;
/// "Very strong" (Kass and Raftery 1995): a choice that BIC misses so much is not looked at again.
inline constexpr double kClearBic = 10.0;
/// Below, BIC speaks for neither strongly (Kass and Raftery): another effect in its place is a draw.
inline constexpr double kDraw = 6.0;
/// "Not worth more than a bare mention" (the same): the order of the catalogue decides.
inline constexpr double kTie = 2.0;
/// BIC of an effect that may want a partner, and of two taken at once: far beyond kClearBic, since there are
/// as many pairs as effects squared.
inline constexpr double kPromising = 40.0;
/// Share of a chosen effect's evidence that another has alone, at least, to be a rival of it: a rival says
/// much the same, so that with less than a third of it, it does not.
inline constexpr double kNoRival = 0.3;

// Corrections without a mechanism.

/// nats on held-out rows that make one clear: by chance one of e^6 = 400 does so much.
inline constexpr double kClearForm = 6.0;
/// Standard errors of that gain between blocks: one-sided 2.3 %.
inline constexpr double kFormErrors = 2.0;
/// Times that errors are exchanged inside their runs, where the runs disagree about a correction: the best of
/// 19 is beyond all of them by chance once in 20.
inline constexpr int kExchanges = 19;
/// Robust deviations beyond which a reading is wild, and beyond which no tail of an error's law goes
/// (Student's t of four degrees of freedom: once in 40 000).
inline constexpr double kWild = 5.0;
inline constexpr double kFar = 20.0;
/// Wild readings below which nothing is said of them.
inline constexpr double kLeastWild = 5.0;
/// Wild readings that are neighbours more often than chance makes them: by so many times and deviations (one
/// in 30 000, for want of a law of their number).
inline constexpr double kManyTimes = 1.5, kManyDeviations = 4.0;

// Jumps inside a run.

/// Batches of a chain by whose differences its errors' scatter is known: few and long ones (Schmeiser 1982),
/// eight leave seven differences. Of a side shorter than one nothing can be said.
inline constexpr std::size_t kJumpBatches = 8;
/// Rows of a chain, at least: three to a batch. And rows of a side, at least: with four the mean of errors of
/// heavy tails is near normal.
inline constexpr std::size_t kJumpChain = 3 * kJumpBatches, kJumpSide = 4;
/// Robust deviations to which errors are pulled in: normal ones go beyond once in 16 000.
inline constexpr double kJumpTrim = 4.0;
/// Chains whose quartiles say how high the others go: with fewer there are none.
inline constexpr std::size_t kJumpChains = 4;
/// Median of the square of a standard normal deviation, and the Gumbel scale of the largest of many squares
/// (their tail falls as exp(-x / 2)).
inline constexpr double kSquareMedian = 0.4549, kSquareScale = 2.0;

/// Of a plausible range (of its logarithm where it spans more than kWideRange to one): nearer than this to
/// its end a fit was stopped there. The solver ends within a thousandth of a bound that holds it.
inline constexpr double kRangeEnd = 0.005;
inline constexpr double kWideRange = 10.0;

/// Correlation beyond which two parameters are one number that the data cannot part: 1 - r^2 of 6 % is left
/// to tell them by.
inline constexpr double kOneNumber = 0.97;

}  // namespace puckloop::gap::thresholds
