#pragma once
// Numbers and observables as a person reads them.

#include <cmath>
#include <string>

namespace puckloop::gap {

/// What a person calls an observable: "distance along the heading" for "along"; columns by their own names.
std::string plain_observable(const std::string& name);

/// "1.23 mm", "12.4 counts", "1.2 %", of a logarithm "a factor of 1.05": a number a person reads, with three
/// or four digits and `more_digits`; in the unit in which `like` is read well, where that is given (an
/// interval beside its value).
std::string quantity(double value, const std::string& unit, int more_digits = 0, double like = NAN);
/// What something is moved by, with its sign: "+1.23 mm".
std::string change(double value, const std::string& unit);
/// The unit of shares and probabilities for these two: always in %.
inline constexpr const char* kShare = "share";

}  // namespace puckloop::gap
