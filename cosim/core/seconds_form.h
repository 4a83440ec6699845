#pragma once
// A time as a description writes it (base/fields): seconds.

#include "base/fields/json_value.h"
#include "cosim/core/time.h"

#include <string>
#include <vector>

namespace puckloop::cosim {

/// Reads back to the picosecond what from_seconds() made.
struct Seconds {
    static JsonValue write(Time time);
    static void read(Time& time, const JsonValue& from, const std::string& place);
    static JsonValue write(const std::vector<Time>& times);
    static void read(std::vector<Time>& times, const JsonValue& from, const std::string& place);
};

}  // namespace puckloop::cosim
