#include "linuxboard/control/behaviours/booth_lights.h"

#include "linuxboard/control/behaviours/steering.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::control {

namespace {

constexpr double kBooth = 10.0;     // cm
constexpr double kLeastRow = 1.5;   // cm between the outermost lights of a row
constexpr double kMostRow = 9.0;    // cm: more is no row of lights
constexpr double kMostAskew = 0.8;  // rad: from farther aside no light is seen

struct Place {
    double ahead = 0, left = 0;  // cm
};

Place place_of(const ColouredSpot& spot) {
    return {spot.distance_cm * std::cos(spot.bearing), spot.distance_cm * std::sin(spot.bearing)};
}

/// The spots of one booth.
struct Group {
    std::vector<const ColouredSpot*> spots;
    Place sum;
    double area = 0;

    Place middle() const { return {sum.ahead / area, sum.left / area}; }
    bool takes(const ColouredSpot& spot) const {
        const Place here = place_of(spot), there = middle();
        return spot.colour == spots.front()->colour &&
               std::hypot(there.ahead - here.ahead, there.left - here.left) < kBooth;
    }
    void add(const ColouredSpot& spot) {
        const Place here = place_of(spot);
        spots.push_back(&spot);
        sum.ahead += spot.area * here.ahead;
        sum.left += spot.area * here.left;
        area += spot.area;
    }
};

std::optional<double> askew_of(const Group& group) {
    if (group.spots.size() < 2) return std::nullopt;
    const Place middle = group.middle();
    const double bearing = std::atan2(middle.left, middle.ahead);
    const auto [right, left] =
        std::minmax_element(group.spots.begin(), group.spots.end(), [&](const auto* a, const auto* b) {
            return wrapped(a->bearing - bearing) < wrapped(b->bearing - bearing);
        });
    const Place from = place_of(**right), to = place_of(**left);
    const double row = std::hypot(to.ahead - from.ahead, to.left - from.left);
    if (row < kLeastRow || row > kMostRow) return std::nullopt;
    // The axis, out of the booth, is a quarter turn further than the row from the right light to the left
    // one.
    const double axis = std::atan2(to.left - from.left, to.ahead - from.ahead) + std::numbers::pi / 2;
    const double askew = wrapped(axis - (bearing + std::numbers::pi));
    if (std::abs(askew) > kMostAskew) return std::nullopt;
    return askew;
}

}  // namespace

std::vector<BoothLights> booths_of(const std::vector<ColouredSpot>& spots) {
    std::vector<Group> groups;
    for (const ColouredSpot& spot : spots) {
        auto group =
            std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.takes(spot); });
        if (group == groups.end()) group = groups.insert(groups.end(), Group{});
        group->add(spot);
    }
    std::vector<BoothLights> booths;
    for (const Group& group : groups) {
        const Place middle = group.middle();
        booths.push_back({{group.spots.front()->colour, std::atan2(middle.left, middle.ahead),
                           std::hypot(middle.ahead, middle.left), static_cast<int>(group.area)},
                          askew_of(group)});
    }
    return booths;
}

double bearing_of_axis(const ColouredSpot& lights, double askew, double ahead) {
    // In a frame with the lights straight ahead, a distance of 1 away.
    const double x = 1 - ahead * std::cos(askew), y = -ahead * std::sin(askew);
    return wrapped(lights.bearing + std::atan2(y, x));
}

}  // namespace puckloop::control
