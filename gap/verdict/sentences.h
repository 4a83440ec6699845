#pragma once
// The verdict in plain words.

#include "gap/fit_test/rival_forms.h"
#include "gap/verdict/verdict.h"

#include <cmath>
#include <string>

namespace puckloop::gap {

/// "1.23 mm", "12.4 counts", "1.2 %", of a logarithm "a factor of 1.05": a number a person reads, with three
/// or four digits and `more_digits`; in the unit in which `like` is read well, where that is given (an
/// interval beside its value).
std::string quantity(double value, const std::string& unit, int more_digits = 0, double like = NAN);
/// What something is moved by, with its sign: "+1.23 mm".
std::string change(double value, const std::string& unit);
/// The unit of shares and probabilities for these two: always in %.
inline constexpr const char* kShare = "share";
/// What a cause says about this robot: title and its parameters with intervals.
std::string cause_sentence(const Cause& cause);
/// Whether an effect's form is told from its neighbours'; empty where it is.
std::string form_words(const FormVerdict& form);
/// Why an effect was not tried: "needs a or b to be recorded" for a candidate's "needs a|b to be recorded".
std::string plain_remark(std::string remark);
std::string gain_sentence(const Held& held);
/// What a term without a mechanism gains, and whether a run takes it.
std::string extension_sentence(const Extension& extension);
/// One or two sentences at the top of the report.
std::string summary_of(const Verdict& verdict);

}  // namespace puckloop::gap
