#pragma once
// How often what is said of drawn cases, against the strength of what is hidden and against the number of
// runs.

#include "selftest/grammar/rates.h"

#include <array>
#include <string>
#include <vector>

namespace puckloop::gap::selftest::grammar {

enum class Said { RightName, OtherName, Unexplained, CannotTell, NoEffect, Failed };
inline constexpr std::size_t kSaid = 6;
const char* said_name(Said said);
/// A right name: of a known effect itself, of a near miss its family.
Said said_of(const Outcome& outcome);
/// Is that what should be said of such a case?
bool rightly(const Outcome& outcome);

/// Ends of the bands: strength over noise, number of runs.
inline constexpr std::array<double, 5> kStrengths{0.5, 1.0, 2.0, 4.0, 8.5};
inline constexpr std::array<double, 5> kRuns{2, 4, 8, 16, 1000};

struct Band {
    double low = 0.0, high = 0.0;  ///< the same: one number
    std::array<int, kSaid> count{};
    int right = 0, of = 0;
};
using Curve = std::vector<Band>;

Curve by_strength(const std::vector<Outcome>& cases, Class of);
/// Of cases of strength 1 and above, and of nulls.
Curve by_runs(const std::vector<Outcome>& cases, Class of);

/// At each of kPowerRuns, of all strengths: what run_power gives.
Curve power(const std::vector<Outcome>& cases, Class of);
std::string power_text(const std::vector<Outcome>& cases, const std::string& seeds);
std::string power_svg(const std::vector<Outcome>& cases);

/// Tables of both, and of every known effect.
std::string curves_text(const std::vector<Outcome>& cases);
/// Sensitivity, power against runs, ranks of true parameters, as SVG.
std::string curves_svg(const std::vector<Outcome>& cases);

}  // namespace puckloop::gap::selftest::grammar
