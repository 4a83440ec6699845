#include "reproductions/density/density.h"

#include "cosim/core/time.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace puckloop::tools {

void DensityClass::add(const DensityClass& other) {
    frames += other.frames;
    heard += other.heard;
    steps += other.steps;
    steps_heard += other.steps_heard;
    for (std::size_t i = 0; i < lost.size(); ++i)
        lost[i] += other.lost[i];
}

void Density::add(const Density& other) {
    for (std::size_t i = 0; i < classes.size(); ++i)
        classes[i].add(other.classes[i]);
    neighbours.add(other.neighbours);
}

Density density_of(const std::vector<Fate>& fates, double from_s, double to_s) {
    struct Pair {
        double distance = 0.0;
        std::set<long> heard_in;  // steps
    };
    std::map<std::pair<std::string, std::string>, Pair> pairs;
    Density density;
    const auto each = [&](double distance, auto act) {
        for (std::size_t i = 0; i < density.classes.size(); ++i)
            if (distance >= kDensityEdges[i] && distance < kDensityEdges[i + 1]) act(density.classes[i]);
        if (distance < kNeighbour) act(density.neighbours);
    };
    for (const Fate& fate : fates) {
        const double begin = cosim::to_seconds(fate.frame.start);
        if (begin < from_s || begin >= to_s) continue;
        Pair& pair = pairs[{fate.frame.sender, fate.frame.receiver}];
        pair.distance = fate.frame.distance;
        if (fate.delivered) pair.heard_in.insert(std::lround(std::floor((begin - from_s) / kDensityStep)));
        each(pair.distance, [&](DensityClass& one) {
            ++one.frames;
            if (fate.delivered)
                ++one.heard;
            else
                ++one.lost[static_cast<std::size_t>(fate.cause)];
        });
    }
    const auto steps = static_cast<std::size_t>(std::lround((to_s - from_s) / kDensityStep));
    for (const auto& [names, pair] : pairs)
        each(pair.distance, [&, &pair = pair](DensityClass& one) {
            one.steps += steps;
            one.steps_heard += pair.heard_in.size();
        });
    return density;
}

}  // namespace puckloop::tools
