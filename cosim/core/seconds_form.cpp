#include "cosim/core/seconds_form.h"

#include "base/fields/json.h"

#include <cmath>

namespace puckloop::cosim {

namespace {

/// to_seconds() may be off by its last bit, which is more than half a picosecond after half an hour.
double exact_seconds(Time time) {
    const double seconds = to_seconds(time);
    for (const double one : {seconds, std::nextafter(seconds, 1e9), std::nextafter(seconds, -1e9)})
        if (from_seconds(one) == time) return one;
    return seconds;
}

}  // namespace

JsonValue Seconds::write(Time time) {
    return exact_seconds(time);
}

void Seconds::read(Time& time, const JsonValue& from, const std::string& place) {
    double seconds = 0.0;
    from_value(seconds, from, place);
    time = from_seconds(seconds);
}

JsonValue Seconds::write(const std::vector<Time>& times) {
    JsonValue list = JsonValue::Array{};
    for (const Time time : times)
        list.push(write(time));
    return list;
}

void Seconds::read(std::vector<Time>& times, const JsonValue& from, const std::string& place) {
    std::vector<double> list;
    from_value(list, from, place);
    times.clear();
    for (const double seconds : list)
        times.push_back(from_seconds(seconds));
}

}  // namespace puckloop::cosim
