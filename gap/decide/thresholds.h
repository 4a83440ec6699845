#pragma once
// Every number that the decision rests on, and why it is what it is. Nothing here is keyed on an effect.

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

/// Corrected p of a structure worth reporting, and of one that alone makes "no effect" untrue: with some
/// hundred structures looked at in a verdict, corrected (Holm), 1e-3 makes one false alarm in a thousand.
inline constexpr double kReported = 0.01;
inline constexpr double kSure = 1e-3;

/// Of what a cause gains that moves means: at least this much must come from the means it moves, the rest
/// may come from the scatter that goes with them. Half: else it is scatter by another name.
inline constexpr double kMeanShare = 0.5;

/// A sum whose own noise is less than this part of its rounding is not asked row by row: what rows say is
/// what the rounding says (a step of q has a sd of 0.29 q, which then is all there is).
inline constexpr double kFineNoise = 0.25;

/// Runs below which stretches of one run are held out, which share its day and place.
inline constexpr std::size_t kRunsThatJudge = 3;
/// Runs below which there are no two halves to confirm on: each half needs two runs to be judged by.
inline constexpr std::size_t kRunsToConfirm = 4;

/// Of a plausible range (of its logarithm where it spans more than kWideRange to one): nearer than this to
/// its end a fit was stopped there. The solver ends within a thousandth of a bound that holds it.
inline constexpr double kRangeEnd = 0.005;
inline constexpr double kWideRange = 10.0;

/// Correlation beyond which two parameters are one number that the data cannot part: 1 - r^2 of 6 % is left
/// to tell them by.
inline constexpr double kOneNumber = 0.97;

}  // namespace puckloop::gap::thresholds
