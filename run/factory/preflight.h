#pragma once
// What can be known to fail before the run begins, and before an earlier run's results are touched.

#include "run/description/run_setup.h"

namespace puckloop::tools {

/// Loads every firmware image into its chip and looks at every Linux program. Throws InputError.
void check_files(const RunSetup& setup);

}  // namespace puckloop::tools
