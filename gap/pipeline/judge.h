#pragma once
// Decide: the grounds, from the cheap to the dear, and what follows from them (gap/decide/decide.cpp). Causes
// that are doubted by themselves go; where the rest is doubted, all are taken back and what they had covered
// is diagnosed anew.

#include "gap/decide/confirm.h"
#include "gap/decide/decide.h"
#include "gap/pipeline/diagnose.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::gap {

struct Judged {
    Decision decision = Decision::NoEffect;
    Grounds grounds;  ///< of the causes, as they were judged
    std::string doubt;
    Chosen chosen;             ///< what stands
    Diagnosis diagnosis;       ///< of it
    double unexplained = 0.0;  ///< share of all that is gained
    double found = 0.0;  ///< nats gained by what stands and by corrections without a mechanism beside it
    /// What came nearest, where it was taken back.
    std::optional<Chosen> refused;
    std::vector<std::pair<std::size_t, FormVerdict>> refused_forms;
    std::vector<std::size_t> not_identified;  ///< of what was taken back: what these data cannot identify
    Confirmation confirmation;                ///< of what is named
    std::vector<std::string> cautions;        ///< of causes that were let go
};

/// How a set of causes is put to the test of runs that had no part in it.
struct Judging {
    std::uint64_t seed = 1;
    bool ask_all = false;  ///< also what no longer changes the decision
    /// Analyses half an experiment as one of its own; empty: not confirmed.
    std::function<Asked(const Experiment&)> ask;
};

Judged judged(const Study& study, Chosen chosen, Diagnosis diagnosis, const Judging& how);

}  // namespace puckloop::gap
