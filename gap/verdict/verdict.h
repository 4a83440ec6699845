#pragma once
// What the analysis says: the content of gap.json and of the report. Numbers in SI units unless a unit stands
// beside them.

#include "gap/data/experiment.h"
#include "gap/decide/confirmation.h"
#include "gap/decide/decide.h"
#include "gap/findings/extension.h"
#include "gap/findings/findings.h"
#include "gap/findings/predictive.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap {

/// "named", "cannot_tell", "no_effect", "unexplained", "not_identifiable"
std::string_view decision_name(Decision decision);

struct Verdict {
    Decision decision = Decision::NoEffect;
    Kind kind = Kind::Proximity;
    std::uint64_t seed = 1;
    std::string summary;  ///< one or two plain sentences
    std::vector<Cause> causes;
    std::vector<Rival> rivals;
    Held heldout;
    std::vector<HeldObservable> observables;
    std::vector<Suggestion> suggestions;  ///< best first
    std::vector<Leftover> leftovers;
    std::vector<FreeForm> free_forms;  ///< of each observable, what gains most first: unexplained
    double unexplained_share = 0.0;    ///< of all that is gained: free forms over free forms and causes
    std::string doubt;                 ///< why what came nearest is no cause, in words that follow "but"
    std::vector<Cause> nearest;        ///< where nothing stands as a cause: what came nearest, and left much
    Grounds grounds;                   ///< of the causes, as they were selected
    Confirmation confirmation;         ///< of what is named, on runs that had no part in it
    Extension extension;               ///< what remains, as a term without a mechanism
    std::vector<Tried> tried;
    std::vector<FittedParameter> nuisance;  ///< fitted along with every model: tracker offset and delay, ...
    std::vector<std::string> cautions;
    Rerun rerun;
    std::vector<PredictiveCheck>
        predictive;              ///< each observable as it is, then with the causes; in gap.json p only
    std::vector<Series> series;  ///< not in gap.json
};

/// gap.json as text. Same verdict, same bytes.
std::string to_json(const Verdict& verdict);

/// Could another effect stand in the place of a cause that matters: of the first, or of one that makes more
/// than a fifth of what all gain? A smaller part is told with its rival and leaves the first as clear as it
/// is.
bool doubtful(const Verdict& verdict);

}  // namespace puckloop::gap
