#pragma once
// A table whose keys are the fields of a struct (base/fields/field.h): units, ranges and defaults are its
// own.

#include "base/fields/field.h"
#include "scenarios/values/reader.h"

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <type_traits>

namespace puckloop::scenarios {

/// Of one field.
void read_number(Reader& reader, const auto& one, double& value) {
    value = reader.quantity(one.key, dimension_of(one.unit), value);
    if (!(value >= one.least && value <= one.most) || (one.open && value == one.least))
        reader.fail(one.key, fmt::format("{} is out of range", one.key),
                    fmt::format("{:g} to {:g} {}", one.least, one.most, one.unit == "1" ? "" : one.unit));
}

/// Every field is a number with its unit, a whole number, a text or a yes or no; what texts there may be is
/// for the caller. Throws InputError, also at a key that is no field.
template <Described T>
void read_fields(Reader reader, T& result) {
    const auto read = [&](const auto& one) {
        auto& value = result.*one.member;
        using Value = std::remove_reference_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::string>) {
            value = reader.text(one.key, value);
        } else if constexpr (std::is_same_v<Value, bool>) {
            value = reader.flag(one.key, value);
        } else if constexpr (std::is_integral_v<Value>) {
            value = reader.integer(one.key, value, static_cast<std::int64_t>(one.least),
                                   static_cast<std::int64_t>(one.most));
        } else {
            read_number(reader, one, value);
        }
    };
    for_each_entry<T>(read);
    reader.finish();
}

}  // namespace puckloop::scenarios
