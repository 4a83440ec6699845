#pragma once
// Times on the command line.

#include "tools/cli/check.h"

#include <string>

namespace puckloop::tools {

/// A time from `low` to `high` seconds, both included: "5 s", "5s", "500 ms", or "5", which are seconds. The
/// option reads seconds.
Check seconds_between(double low, double high);

/// What `Check::shown` is of such a check: options read seconds_text() of their words.
inline constexpr const char* kTimeShown = "TIME";

/// A time that the check let through, as a number of seconds.
std::string seconds_text(const std::string& text);

}  // namespace puckloop::tools
