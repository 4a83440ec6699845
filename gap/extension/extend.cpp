#include "gap/extension/extend.h"

#include "gap/diagnostics/heldout.h"
#include "gap/extension/formula.h"
#include "gap/extension/held_costs.h"
#include "gap/extension/learn.h"
#include "gap/fit/parallel.h"
#include "physics/description/extension.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace puckloop::gap {

namespace {

constexpr std::size_t kLeastToExtend = 60, kLeastHeldBlocks = 2;

/// A drive is looked at along its own axes, whatever view the study has: there its errors are what it makes.
class Looked {
  public:
    explicit Looked(const Study& study) : study_(study) {
        if (study.experiment().kind == Kind::Motion && study.view() != MotionView::Robot)
            own_ = make_model(study.experiment(), MotionView::Robot);
    }
    const Model& model() const { return own_ ? *own_ : study_.model(); }
    /// The study's values by name; else neutral.
    std::vector<double> values(const std::vector<double>& of_study) const {
        if (!own_) return of_study;
        std::vector<double> values = own_->neutral();
        for (std::size_t j = 0; j < values.size(); ++j)
            if (const auto found = study_.model().find(own_->parameters()[j].name))
                values[j] = of_study[*found];
        return values;
    }

  private:
    const Study& study_;
    std::unique_ptr<Model> own_;
};

/// Figures of one observable's rows, each by the fold that did not see it.
struct HeldRows {
    std::vector<double> before, named, extended;  // errors
    std::vector<double> cost_named, cost_extended;
};

class Extending {
  public:
    Extending(const Study& study, const Fit& none, const Fit& named)
        : study_(study), none_(none), named_(named), looked_(study) {}

    Extension extended(std::uint64_t seed) {
        Extension extension;
        extension.not_asked.clear();
        const std::vector<double> values = looked_.values(named_.fitted.state.values);
        const auto subjects =
            subjects_of(study_.experiment(), looked_.model(), values, looked_.model().predicted(values));
        if (subjects.empty() || subjects.front().error.size() < kLeastToExtend ||
            study_.blocks().count < kLeastHeldBlocks) {
            extension.not_asked = "there are too few rows to learn from and to be judged by";
            return extension;
        }
        rows_.resize(subjects.size());
        for (std::size_t s = 0; s < subjects.size(); ++s)
            for (auto* of : {&rows_[s].before, &rows_[s].named, &rows_[s].extended, &rows_[s].cost_named,
                             &rows_[s].cost_extended})
                of->assign(subjects[s].error.size(), 0.0);
        std::vector<Learnt> whole(subjects.size());
        in_parallel(study_.folds() + 1, study_.threads(), [&](std::size_t k) {
            if (k < study_.folds()) return hold_out(k);
            for (std::size_t s = 0; s < subjects.size(); ++s)
                whole[s] = learnt_from(subjects[s], std::vector<char>(subjects[s].error.size(), 1));
        });
        for (std::size_t s = 0; s < subjects.size(); ++s)
            extension.observables.push_back(judged(subjects[s], rows_[s], subjects.size(), seed));
        for (std::size_t s = 0; s < subjects.size(); ++s) {
            Extended& one = extension.observables[s];
            one.kept = one.kept && !whole[s].parts.empty();
            if (!one.kept) continue;
            one.formula = formula_of(subjects[s], std::vector<char>(subjects[s].error.size(), 1), whole[s]);
            one.tables = tables_of(subjects[s], whole[s]);
        }
        return extension;
    }

  private:
    void hold_out(std::size_t fold) {
        const Experiment& experiment = study_.experiment();
        const Model& model = looked_.model();
        const auto none = looked_.values(without(fold, none_)),
                   named = named_.effects == none_.effects ? none : looked_.values(without(fold, named_));
        const Prediction as_it_is = model.predicted(none), with_causes = model.predicted(named);
        const auto subjects = subjects_of(experiment, model, named, with_causes);
        for (std::size_t s = 0; s < subjects.size() && s < rows_.size(); ++s) {
            const Subject& subject = subjects[s];
            const auto& folds = study_.fold_of()[subject.observable];
            std::vector<char> used;
            for (const int one : folds)
                used.push_back(one != static_cast<int>(fold) ? 1 : 0);
            const Learnt learnt = learnt_from(subject, used);
            const auto added = learnt.in_rows(subject);
            const auto cost_named = held_costs(subject, used, learnt, false),
                       cost_extended = held_costs(subject, used, learnt, true);
            const Observable& observable = model.observables()[subject.observable];
            const std::size_t o = subject.observable;
            for (std::size_t i = 0; i < folds.size(); ++i) {
                if (used[i] != 0) continue;
                const double seen = observable.y[i], says = shown(with_causes[o], i);
                rows_[s].before[i] = seen - shown(as_it_is[o], i);
                rows_[s].named[i] = seen - says;
                rows_[s].extended[i] = seen - observable.instrument.clipped(says + added[i]);
                rows_[s].cost_named[i] = cost_named[i];
                rows_[s].cost_extended[i] = cost_extended[i];
            }
        }
    }

    /// Values that all rows but those of the fold have.
    std::vector<double> without(std::size_t fold, const Fit& fit) const {
        const bool any = !fit.freed.empty() || !study_.model().nuisances().empty();
        return any ? study_.without_fold(fold, fit, kHeldOut).state.values : fit.fitted.state.values;
    }

    Extended judged(const Subject& subject, const HeldRows& rows, std::size_t asked,
                    std::uint64_t seed) const {
        const Observable& observable = looked_.model().observables()[subject.observable];
        const auto& block = study_.blocks().of[subject.observable];
        const std::size_t blocks = study_.blocks().count;
        std::vector<double> before(blocks, 0.0), named(blocks, 0.0), extended(blocks, 0.0), gain(blocks, 0.0);
        for (std::size_t i = 0; i < block.size(); ++i) {
            before[block[i]] += rows.before[i] * rows.before[i];
            named[block[i]] += rows.named[i] * rows.named[i];
            extended[block[i]] += rows.extended[i] * rows.extended[i];
            gain[block[i]] += rows.cost_named[i] - rows.cost_extended[i];
        }
        Extended one;
        one.observable = observable.name;
        one.unit = observable.unit;
        one.quantity = subject.quantity;
        one.quantity_unit = subject.quantity_unit;
        const auto count = static_cast<double>(block.size());
        HeldObservable against_none, against_named;
        compare_errors(before, extended, count, seed, against_none);
        compare_errors(named, extended, count, seed, against_named);
        one.before = against_none.before;
        one.named = against_named.before;
        one.extended = against_named.after;
        one.ratio = against_named.ratio;
        one.low = against_named.low;
        one.high = against_named.high;
        const Gain all = gain_of(gain);
        one.gain = all.sum;
        one.gain_sd = all.sd;
        one.blocks = static_cast<int>(blocks);
        for (std::size_t k = 0; k < blocks; ++k)
            one.better += extended[k] < named[k] ? 1 : 0;
        one.kept = gains_enough(all, asked, 1) && one.ratio < 1;
        return one;
    }

    static std::vector<LearntTable> tables_of(const Subject& subject, const Learnt& learnt) {
        double most = INFINITY;
        if (const auto extended = physics::extended_named(subject.quantity))
            most = physics::extended_quantities()[static_cast<std::size_t>(*extended)].most;
        std::vector<LearntTable> tables;
        for (const LearntPart& part : learnt.parts) {
            const TableShape& shape = part.basis.shape();
            LearntTable table;
            if (shape.times >= 0)
                table.times = subject.covariates[static_cast<std::size_t>(shape.times)].name;
            if (shape.by_run) {
                table.value = {0.0};
                table.run_spread = std::min(part.spread, most);
                tables.push_back(std::move(table));
                continue;
            }
            for (const std::size_t c : shape.over)
                table.over.push_back(subject.covariates[c].name);
            table.at = part.basis.places();
            for (std::size_t t = 0; t < part.basis.tables(); ++t) {
                table.sensor = shape.by_sensor ? static_cast<int>(t) : -1;
                table.value.clear();
                table.sd.clear();
                bool any = false;
                for (std::size_t v = 0; v < part.basis.values(); ++v) {
                    const auto place = static_cast<Eigen::Index>(t * part.basis.values() + v);
                    table.value.push_back(std::clamp(part.value[place], -most, most));
                    table.sd.push_back(std::min(part.sd[place], most));
                    any = any || part.value[place] != 0.0;
                }
                if (any) tables.push_back(table);
            }
        }
        return tables;
    }

    const Study& study_;
    const Fit &none_, &named_;
    Looked looked_;
    std::vector<HeldRows> rows_;
};

}  // namespace

Extension extension_of(const Study& study, const Fit& none, const Fit& named, std::uint64_t seed) {
    Extension extension = Extending(study, none, named).extended(seed);
    extension.by_runs = study.experiment().runs.size() >= static_cast<std::size_t>(3);
    if (!study.experiment().assumed.empty())
        for (Extended& one : extension.observables)
            one.quantity.clear();
    return extension;
}

}  // namespace puckloop::gap
