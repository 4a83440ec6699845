#pragma once
// A table whose keys are the fields of a struct (base/fields/field.h): units, ranges and defaults are its
// own.

#include "base/fields/field.h"
#include "scenarios/values/reader.h"

#include <fmt/format.h>

namespace puckloop::scenarios {

/// Every field is a number with its unit. Throws InputError, also at a key that is no field.
template <Described T>
void read_fields(Reader reader, T& result) {
    const auto read = [&](const auto& one) {
        double& value = result.*one.member;
        value = reader.quantity(one.key, dimension_of(one.unit), value);
        if (!(value >= one.least && value <= one.most) || (one.open && value == one.least))
            reader.fail(one.key, fmt::format("{} is out of range", one.key),
                        fmt::format("{:g} to {:g} {}", one.least, one.most, one.unit == "1" ? "" : one.unit));
    };
    for_each_entry<T>(read);
    reader.finish();
}

}  // namespace puckloop::scenarios
