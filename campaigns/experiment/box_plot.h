#pragma once
// Box plots of scores.

#include <string>
#include <utility>
#include <vector>

namespace puckloop::swarm {

/// A box from the first to the third quartile with a line at the median; whiskers to the last value within
/// 1.5 times the box's height of it, dots beyond (Tukey, 1977). In the order given; SVG text.
std::string box_plot(const std::string& title, const std::string& axis,
                     const std::vector<std::pair<std::string, std::vector<double>>>& samples);

}  // namespace puckloop::swarm
