#pragma once
// IRcom's infra-red medium in a run: there where a scenario asks for it, or has both robots and TAMs.

#include "run/description/run_setup.h"

namespace puckloop::tools {

/// The medium and its links to every robot's main board and every TAM, which are there already.
void add_ircom(RunSetup& setup);

}  // namespace puckloop::tools
