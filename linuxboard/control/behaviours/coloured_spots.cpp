#include "linuxboard/control/behaviours/coloured_spots.h"

#include <algorithm>

namespace puckloop::control {

namespace {

constexpr std::size_t kWidth = 352, kHeight = 288;
constexpr int kLeast = 3;  // pixels: a booth that shines red covers six from inside; noise makes single ones

struct Wanted {
    ColouredSpot::Colour colour;
    const char* name;
};
constexpr Wanted kWanted[] = {{ColouredSpot::Colour::Red, "red"},
                              {ColouredSpot::Colour::Green, "green"},
                              {ColouredSpot::Colour::Blue, "blue"}};

}  // namespace

ColouredSpots::ColouredSpots(const std::string& device) : camera_(device, kWidth, kHeight) {}

std::vector<ColouredSpot> ColouredSpots::look() {
    const std::span<const std::uint8_t> picture = camera_.newest();
    std::vector<ColouredSpot> spots;
    if (picture.empty()) return spots;
    for (const Wanted& wanted : kWanted)
        for (const ColourBlob& blob : find_blobs(picture, camera_.width(), camera_.height(),
                                                 *colour_named(wanted.name), mirror_, kLeast))
            spots.push_back({wanted.colour, blob.bearing, blob.distance_cm, blob.area});
    std::stable_sort(spots.begin(), spots.end(),
                     [](const ColouredSpot& a, const ColouredSpot& b) { return a.area > b.area; });
    return spots;
}

}  // namespace puckloop::control
