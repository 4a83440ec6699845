#include "gap/effects/effect.h"
#include "gap/kinds/description.h"

#include <algorithm>
#include <utility>

namespace puckloop::gap {

std::span<const Effect> catalogue() {
    static const std::vector<Effect> all = [] {
        std::vector<Effect> effects;
        const std::pair<Kind::Builtin, std::vector<Effect> (*)()> tables[] = {
            {Kind::Motion, motion_effects},         {Kind::Proximity, proximity_effects},
            {Kind::Ground, ground_effects},         {Kind::Accelerometer, accelerometer_effects},
            {Kind::Microphone, microphone_effects}, {Kind::Rab, rab_effects},
            {Kind::Timing, timing_effects}};
        for (const auto& [kind, table] : tables)
            for (Effect& effect : table()) {
                effect.kinds.insert(effect.kinds.begin(), kind);
                effects.push_back(std::move(effect));
            }
        return effects;
    }();
    return all;
}

std::vector<const Effect*> effects_of(const Kind& kind) {
    std::vector<const Effect*> found;
    if (const Description* own = kind.description()) {
        for (const Effect& effect : own->effects)
            found.push_back(&effect);
        return found;
    }
    for (const Effect& effect : catalogue())
        if (std::find(effect.kinds.begin(), effect.kinds.end(), Kind::Builtin(kind)) != effect.kinds.end())
            found.push_back(&effect);
    return found;
}

}  // namespace puckloop::gap
