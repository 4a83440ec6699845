#pragma once
// Diagnose: what is left with the chosen causes, asked by discrepancies that know no effect. Changes nothing.

#include "gap/fit_test/rival_forms.h"
#include "gap/pipeline/choose.h"
#include "gap/verdict/verdict.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace puckloop::gap {

struct Diagnosis {
    std::vector<Series> series;               ///< every observable, before and after
    std::vector<Leftover> structures;         ///< functions of columns, evenness, what no replicate shows
    std::vector<Leftover> leftovers;          ///< these and what differs by runs, jumps and
                                              ///< wanders; the surest first
    std::vector<FreeForm> free_forms;         ///< corrections without a mechanism
    std::vector<PredictiveCheck> predictive;  ///< of this fit; none where all adds up
    double left_by_run = 0.0;                 ///< nats that a number for each run gains
    std::vector<std::pair<std::size_t, FormVerdict>> forms;  ///< of the chosen effects (candidates)
};

Diagnosis diagnosed(const Study& study, const Chosen& chosen, std::uint64_t seed);

}  // namespace puckloop::gap
