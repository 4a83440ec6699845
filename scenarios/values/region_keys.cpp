#include "scenarios/values/region_keys.h"

#include <fmt/format.h>

namespace puckloop::scenarios {

namespace {
constexpr double kLargest = 1000.0;  // m
}

missions::Region read_region(Reader& reader) {
    missions::Region region;
    if (reader.has("centre")) {
        const auto centre = reader.quantities("centre", Dimension::Length, 2);
        region.x = centre[0];
        region.y = centre[1];
    }
    const auto size = [&](const char* key, double value) {
        if (!(value > 0.0 && value <= kLargest))
            reader.fail(key, fmt::format("{} is out of range", key), "more than 0 m, at most 1000 m");
        return value;
    };
    region.disc = reader.choice("shape", "rectangle", {"rectangle", "disc"}) == "disc";
    if (const char* other = region.disc ? "size" : "radius"; reader.has(other))
        reader.fail(other, fmt::format("a {} has no {}", region.disc ? "disc" : "rectangle", other),
                    region.disc ? "radius" : "size");
    if (region.disc) {
        region.radius = size("radius", reader.quantity("radius", Dimension::Length));
    } else {
        const auto sides = reader.quantities("size", Dimension::Length, 2);
        region.length = size("size", sides[0]);
        region.width = size("size", sides[1]);
    }
    return region;
}

}  // namespace puckloop::scenarios
