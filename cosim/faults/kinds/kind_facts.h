#pragma once
// What else is known of a kind of fault, for whoever plans a run and reports on it.

#include "cosim/faults/spec/fault_spec.h"

#include <string_view>

namespace puckloop::cosim {

/// Why a fault of this kind may never have fired though its window was reached; empty: nothing is known.
std::string_view why_silent(const FaultSpec& fault);

/// It is the battery's: every board that hangs on it suffers, not only the one that the fault names.
bool is_of_battery(const FaultSpec& fault);

/// It ends a program without ending the run, which then has to end otherwise.
bool outlives_program(const FaultSpec& fault);

}  // namespace puckloop::cosim
