#pragma once
// The step between two values that an instrument, a log or a tracker can write down: clocks in whole
// milliseconds, poses in whole millimetres. Rounding is part of what was measured, whether or not the
// experiment says so.

#include <vector>

namespace puckloop::gap {

/// The largest step of which all differences between the values are whole multiples; 0: none is seen (fewer
/// than three different values, or as good as continuous).
double quantum_of(const std::vector<double>& values);

}  // namespace puckloop::gap
