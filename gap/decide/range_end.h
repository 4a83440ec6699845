#pragma once
// Was a parameter found where it stands, or stopped there at the end of what is believed of it?

namespace puckloop::gap {

/// The end of the range [low, high] at which `value` stands, as a share of the range: of its logarithm where
/// a range of one sign spans more than ten to one (20 to 2000 s), else of itself. NaN: at none. An end of 0
/// is a mechanism that is not there, one of 1 above it all of a share, and one beside `neutral` is the
/// simulator itself: none of them counts.
double range_end(double value, double low, double high, double neutral);

}  // namespace puckloop::gap
