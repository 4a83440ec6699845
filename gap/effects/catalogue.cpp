#include "gap/effects/effect.h"
#include "gap/effects/tables.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace puckloop::gap {

std::span<const Effect> catalogue() {
    static const std::vector<Effect> all = [] {
        std::vector<Effect> effects;
        for (const auto table : {motion_effects, proximity_effects, ground_effects, accelerometer_effects,
                                 microphone_effects, rab_effects, timing_effects})
            for (Effect& effect : table())
                effects.push_back(std::move(effect));
        return effects;
    }();
    return all;
}

std::vector<const Effect*> effects_of(Kind kind) {
    std::vector<const Effect*> found;
    for (const Effect& effect : catalogue())
        if (std::find(effect.kinds.begin(), effect.kinds.end(), kind) != effect.kinds.end())
            found.push_back(&effect);
    return found;
}

}  // namespace puckloop::gap
