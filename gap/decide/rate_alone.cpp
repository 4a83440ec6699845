#include "gap/decide/rate_alone.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::gap {

namespace {

/// How many of some rows happened; half of one each way is known beforehand (Jeffreys).
struct Count {
    double yes = 0.5, no = 0.5;
    void add(double y) { (y > 0.5 ? yes : no) += 1; }
    double score(double y) const { return std::log((y > 0.5 ? yes : no) / (yes + no)); }
};

}  // namespace

double gained_by_rate(const Study& study, const Selection& selection, std::size_t o) {
    const Observable& observable = study.model().observables()[o];
    if (observable.noise != NoiseKind::Event) return 0.0;
    const auto& fold = study.fold_of()[o];
    std::vector<Count> others(study.folds());
    for (std::size_t i = 0; i < fold.size(); ++i)
        for (std::size_t k = 0; k < others.size(); ++k)
            if (fold[i] != static_cast<int>(k)) others[k].add(observable.y[i]);
    double gained = 0.0;
    for (std::size_t i = 0; i < fold.size(); ++i)
        gained += others[static_cast<std::size_t>(fold[i])].score(observable.y[i]) -
                  selection.held_none.score[o][i];
    return std::max(gained, 0.0);
}

double lowered_by_rate(const Observable& observable, double cost) {
    if (observable.noise != NoiseKind::Event) return 0.0;
    Count all;
    for (const double y : observable.y)
        all.add(y);
    const auto added = [&](double sum, double y) { return sum - all.score(y); };
    return std::max(cost - std::accumulate(observable.y.begin(), observable.y.end(), 0.0, added), 0.0);
}

}  // namespace puckloop::gap
