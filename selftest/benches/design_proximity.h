#pragma once
// What a good laboratory does with a ring of infra-red sensors and a flat wall: each sensor in turn before
// the wall, distances in mixed order, two surfaces, dark and light, motors off and on, slow and fast
// approaches, oblique walls; all of it several times.

#include "base/random.h"
#include "selftest/plain/plain_proximity.h"

#include <map>
#include <string>
#include <vector>

namespace puckloop::gap::selftest {

struct PlannedScenes {
    std::map<std::string, std::string> conditions;
    std::vector<Scene> scenes;
};

/// `one_object`: one sensor before one surface in the dark, which cannot tell a sensor's gain from the
/// surface's reflectivity.
std::vector<PlannedScenes> planned_scenes(RandomStream& random, bool one_object);

}  // namespace puckloop::gap::selftest
