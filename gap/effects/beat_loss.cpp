#include "gap/effects/list.h"

namespace puckloop::gap {

Effect beat_loss() {
    return {
        .name = "beat_loss",
        .number = 55,
        .title = "losses come in spells",
        .mechanism = "Two crystals beat: while the edges meet, frames are lost.",
        .equation = "lost while the phase lies in a window",
        .kinds = {Kind::Rab},
        .parameters = {{"rab.beat", 0.0, 0.7, 0.1, {0.05}, "1-5 % of frames"},
                       {"rab.beat_burst", 0.01, 20.0, 1.0, {0.3}, "beat 10-60 s"}},
        .needs = {"t_s"},
        .observables = "reception in bursts",
        .enters = "ir.spell, ir.spell_time, beside what emerges from the crystals",
        .confounded = {"random_loss"},
        .separated_by = "long records at two temperatures",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
