// A kind that its user described (gap/kinds): its formulas row by row.
//
// Formulas without a parameter are computed once. A value that is not finite, which a fit may meet between
// the values that were tried when the file was read, is replaced by one that no fit keeps.

#include "base/error.h"
#include "gap/kinds/description.h"
#include "gap/models/model.h"
#include "gap/models/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::gap {

namespace {

using Variable = Description::Variable;

constexpr double kRefused = 1e9;  // of a mean that is no number

/// What one observable's formulas are evaluated on.
struct Part {
    std::vector<std::vector<double>> column;      // by column of the kind; empty where no formula has it
    std::vector<std::vector<std::size_t>> place;  // by parameter "per": which of the model's each row has
    std::vector<std::vector<double>> fixed;       // by formula: its values where no parameter is in it
    std::vector<std::size_t> order;               // named formulas that have parameters, in this order
};

class DescribedModel final : public Model {
  public:
    explicit DescribedModel(const Experiment& experiment)
        : kind_(*experiment.kind.description()), first_(kind_.parameters.size()) {
        declare(experiment);
        for (const DescribedObservable& observable : kind_.observables)
            if (experiment.has(kind_.columns[observable.column].name)) add_observable(experiment, observable);
        apply_nominal(experiment);
        if (observables_.empty())
            refuse(experiment, experiment.runs.front(),
                   fmt::format("has no measured column of kind {}", kind_.name), "at least one of them");
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        out.resize(parts_.size());
        for (std::size_t o = 0; o < parts_.size(); ++o) {
            const DescribedObservable& described = *described_[o];
            const Values values = values_of(parts_[o], v);
            take(values, described.mean, out[o].mean);
            for (double& mean : out[o].mean)
                if (!(std::abs(mean) < kRefused)) mean = kRefused;
            out[o].factor.clear();
            out[o].extra.clear();
            if (described.factor) take(values, *described.factor, out[o].factor);
            if (described.sd) take(values, *described.sd, out[o].extra);
            for (double& factor : out[o].factor)
                if (!(factor > 0 && factor < kRefused)) factor = kRefused;
            for (double& sd : out[o].extra)
                if (!(sd >= 0 && sd < kRefused)) sd = kRefused;
        }
    }

  private:
    /// Values of everything that formulas have, at some parameters.
    struct Values {
        const Part& part;
        const std::vector<double>& v;
        std::vector<std::vector<double>> per, formula;  // by parameter, by formula
    };

    /// "KIND.name", or "KIND.name0", ... for each value of a column that is met.
    void declare(const Experiment& experiment) {
        for (std::size_t p = 0; p < kind_.parameters.size(); ++p) {
            const DescribedParameter& one = kind_.parameters[p];
            first_[p] = parameters_.size();
            things_.emplace_back();
            if (one.per.empty()) {
                add(kind_.full_name(one), one.unit, one.neutral);
                continue;
            }
            std::vector<double> all;
            for (const Run& run : experiment.runs) {
                const auto& values = run.column(one.per);
                all.insert(all.end(), values.begin(), values.end());
            }
            for (const double value : distinct(all))
                things_[p].push_back(static_cast<int>(std::lround(value)));
            if (things_[p].empty()) things_[p].push_back(0);
            for (const int thing : things_[p])
                add(fmt::format("{}{}", kind_.full_name(one), thing), one.unit, one.neutral);
        }
    }

    double absent(std::size_t column) const {
        const auto stated = kind_.absent.find(column);
        return stated == kind_.absent.end() ? NAN : stated->second;
    }

    /// Columns of these formulas, those of numbers for each thing among them.
    std::vector<std::size_t> columns_of_formulas(const DescribedObservable& observable) const {
        std::vector<std::size_t> columns;
        const auto add = [&](std::size_t one) {
            if (std::ranges::find(columns, one) == columns.end()) columns.push_back(one);
        };
        for (const std::size_t formula : observable.formulas())
            for (const std::size_t index : kind_.all_used(formula)) {
                const auto [what, place] = kind_.variable(index);
                if (what == Variable::Column) add(place);
                if (what == Variable::Parameter && !kind_.parameters[place].per.empty())
                    add(*kind_.column(kind_.parameters[place].per));
            }
        return columns;
    }

    void add_observable(const Experiment& experiment, const DescribedObservable& described) {
        const auto columns = columns_of_formulas(described);
        std::vector<std::string_view> needed{kind_.columns[described.column].name};
        for (const std::size_t c : columns)
            if (std::isnan(absent(c))) needed.emplace_back(kind_.columns[c].name);
        const Rows rows(experiment, kind_.chain, needed);
        std::vector<std::uint32_t> places;
        Observable observable =
            rows.observable(kind_.columns[described.column].name, described.noise, {}, {}, &places);
        if (observable.y.empty()) return;
        Part part;
        part.column.resize(kind_.columns.size());
        for (const std::size_t c : columns)
            part.column[c] = taken(rows.column(kind_.columns[c].name, absent(c)), places);
        part.place.resize(kind_.parameters.size());
        for (std::size_t p = 0; p < kind_.parameters.size(); ++p) {
            if (kind_.parameters[p].per.empty()) continue;
            const auto& numbers = part.column[*kind_.column(kind_.parameters[p].per)];
            for (const double number : numbers)
                part.place[p].push_back(first_[p] + thing(p, number));
        }
        part.fixed.resize(kind_.formulas.size());
        observables_.push_back(std::move(observable));
        described_.push_back(&described);
        parts_.push_back(std::move(part));
        fix(parts_.back(), described);
    }

    std::size_t thing(std::size_t parameter, double number) const {
        const auto& things = things_[parameter];
        const auto place = std::ranges::find(things, static_cast<int>(std::lround(number)));
        return place == things.end() ? 0 : static_cast<std::size_t>(place - things.begin());
    }

    /// Computes what no parameter is in, and lists what is to be computed each time.
    void fix(Part& part, const DescribedObservable& described) {
        std::vector<char> wanted(kind_.formulas.size(), 0);
        for (const std::size_t formula : described.formulas()) {
            wanted[formula] = 1;
            for (const std::size_t index : kind_.all_used(formula))
                if (const auto [what, place] = kind_.variable(index); what == Variable::Formula)
                    wanted[place] = 1;
        }
        const std::vector<double> neutral_values = neutral();
        for (std::size_t f = 0; f < kind_.formulas.size(); ++f) {
            if (wanted[f] == 0) continue;
            const auto used = kind_.all_used(f);
            const bool moves = std::ranges::any_of(
                used, [&](std::size_t index) { return kind_.variable(index).first == Variable::Parameter; });
            if (moves) {
                if (f < kind_.named_formulas) part.order.push_back(f);
                continue;
            }
            const Values none{part, neutral_values, {}, std::vector<std::vector<double>>(f + 1)};
            std::vector<double> fixed;
            evaluate(none, f, fixed);
            part.fixed[f] = std::move(fixed);
        }
    }

    Values values_of(const Part& part, const std::vector<double>& v) const {
        Values values{part, v, {}, {}};
        values.per.resize(kind_.parameters.size());
        for (std::size_t p = 0; p < kind_.parameters.size(); ++p)
            for (const std::size_t index : part.place[p])
                values.per[p].push_back(v[index]);
        values.formula.resize(kind_.formulas.size());
        for (const std::size_t f : part.order)
            evaluate(values, f, values.formula[f]);
        return values;
    }

    void take(const Values& values, std::size_t formula, std::vector<double>& out) const {
        if (!values.part.fixed[formula].empty())
            out = values.part.fixed[formula];
        else
            evaluate(values, formula, out);
    }

    void evaluate(const Values& values, std::size_t formula, std::vector<double>& out) const {
        std::vector<Formula::Input> inputs;
        const Formula& own = kind_.formulas[formula].formula;
        for (const std::size_t index : own.used()) {
            const auto [what, place] = kind_.variable(index);
            if (what == Variable::Column)
                inputs.push_back({values.part.column[place].data()});
            else if (what == Variable::Parameter && kind_.parameters[place].per.empty())
                inputs.push_back({nullptr, values.v[first_[place]]});
            else if (what == Variable::Parameter)
                inputs.push_back({values.per[place].data()});
            else if (!values.part.fixed[place].empty())
                inputs.push_back({values.part.fixed[place].data()});
            else
                inputs.push_back({values.formula[place].data()});
        }
        const std::size_t part = static_cast<std::size_t>(&values.part - parts_.data());
        out.resize(observables_[part].y.size());
        own.evaluate(inputs, out);
    }

    const Description& kind_;
    std::vector<std::size_t> first_;        // of each of the kind's parameters, in parameters()
    std::vector<std::vector<int>> things_;  // that a parameter has a number for each of
    std::vector<const DescribedObservable*> described_;
    std::vector<Part> parts_;  // of each observable
};

}  // namespace

std::unique_ptr<Model> make_described_model(const Experiment& experiment) {
    return std::make_unique<DescribedModel>(experiment);
}

}  // namespace puckloop::gap
