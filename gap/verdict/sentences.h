#pragma once
// The verdict in plain words.

#include "gap/findings/quantities.h"
#include "gap/fit_test/rival_forms.h"
#include "gap/verdict/verdict.h"

#include <string>

namespace puckloop::gap {

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
