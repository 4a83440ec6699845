#pragma once
// Whether the formulas of a described kind are numbers wherever its file says that they may be asked.

#include "gap/kinds/description.h"

namespace puckloop::gap {

/// Draws values of columns and parameters from their plausible ranges, ends among them, always the same
/// ones. InputError that names file, line and the values where a formula of an observable is not finite, an
/// event's is no probability, or a scatter is negative.
void check_legal_values(const Description& kind);

}  // namespace puckloop::gap
