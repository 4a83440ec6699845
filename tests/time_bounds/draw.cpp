#include "tests/time_bounds/draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::tests {

double Draw::logarithmic(double least, double end) {
    return std::min(end, least * std::pow(end / least, random_.uniform()));
}

std::string Draw::time(double least, double end) {
    return quoted_time(uniform(least, end));
}

std::string quoted_time(double seconds) {
    return fmt::format("\"{:.12f} s\"", seconds);
}

}  // namespace puckloop::tests
