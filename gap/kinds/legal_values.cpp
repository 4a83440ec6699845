#include "gap/kinds/legal_values.h"

#include "base/error.h"
#include "base/random.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr std::size_t kDraws = 400;
constexpr double kLongest = 1e5;    // of ranges wider than this nothing beyond is tried: clocks, counters
constexpr double kRounding = 1e-9;  // of a probability
constexpr double kLargest = 1e100;  // no measurement is, and its square is still a number

/// Ends a quarter of the time each, else anything between.
double drawn_between(double low, double high, RandomStream& random) {
    low = std::max(low, -kLongest);
    high = std::min(high, kLongest);
    const double choice = random.uniform(), share = random.uniform();
    return choice < 0.25 ? low : choice < 0.5 ? high : low + share * (high - low);
}

class Draws {
  public:
    explicit Draws(const Description& kind) : kind_(kind), values_(kind.variables().size()) {
        RandomStream random(1, "gap/kinds/legal_values");
        for (std::size_t v = 0; v < values_.size(); ++v) {
            const auto [what, place] = kind.variable(v);
            if (what == Description::Variable::Formula) continue;
            for (std::size_t k = 0; k < kDraws; ++k)
                values_[v].push_back(what == Description::Variable::Column
                                         ? of_column(kind.columns[place], random)
                                         : of_parameter(kind.parameters[place], k, random));
        }
        for (std::size_t f = 0; f < kind.named_formulas; ++f)
            values_[kind.columns.size() + kind.parameters.size() + f] = evaluated(f);
    }

    std::vector<double> evaluated(std::size_t formula) const {
        std::vector<Formula::Input> inputs;
        for (const std::size_t index : kind_.formulas[formula].formula.used())
            inputs.push_back({values_[index].data()});
        std::vector<double> out(kDraws);
        kind_.formulas[formula].formula.evaluate(inputs, out);
        return out;
    }

    /// "with distance_m = 0.1, half = 0": columns and parameters that the formula has, themselves or in its
    /// parts.
    std::string with(std::size_t formula, std::size_t draw) const {
        const auto names = kind_.variables();
        std::vector<std::string> said;
        for (const std::size_t index : kind_.all_used(formula))
            if (kind_.variable(index).first != Description::Variable::Formula)
                said.push_back(fmt::format("{} = {:.6g}", names[index], values_[index][draw]));
        return said.empty() ? "" : fmt::format(" with {}", fmt::join(said, ", "));
    }

  private:
    static double of_column(const ColumnInfo& column, RandomStream& random) {
        const double value = drawn_between(column.low, column.high, random);
        return column.index ? std::round(value) : value;
    }
    /// Mostly the simulator's own: an effect moves few of them.
    static double of_parameter(const DescribedParameter& parameter, std::size_t draw, RandomStream& random) {
        const double value = drawn_between(parameter.low, parameter.high, random);
        return draw % 4 == 0 || !(parameter.high > parameter.low) ? parameter.neutral : value;
    }

    const Description& kind_;
    std::vector<std::vector<double>> values_;
};

[[noreturn]] void refuse_value(const Description& kind, std::size_t formula, const Draws& draws,
                               std::size_t draw, double value, const char* why, const char* expected) {
    const DescribedFormula& own = kind.formulas[formula];
    throw InputError(kind.file.string(), fmt::format("line {}", own.line),
                     fmt::format("{} is {:.6g}{}{}", own.what, value, why, draws.with(formula, draw)),
                     expected);
}

/// The formula whose value is no number first: a part of the observable's, where it is one.
void check_finite_values(const Description& kind, std::size_t formula, const Draws& draws) {
    const auto refuse_if = [&](std::size_t one) {
        const auto values = draws.evaluated(one);
        for (std::size_t k = 0; k < values.size(); ++k)
            if (!(std::abs(values[k]) < kLargest))
                refuse_value(kind, one, draws, k, values[k], "",
                             "a number for all values in the ranges stated; narrower ranges, or clip(), "
                             "max() or a condition in the formula");
    };
    // A part may be infinite where the whole is not (1 / (1 + exp(x))), so the whole decides, and its parts
    // are named.
    const auto whole = draws.evaluated(formula);
    if (std::ranges::all_of(whole, [](double value) { return std::abs(value) < kLargest; })) return;
    for (const std::size_t index : kind.all_used(formula))
        if (const auto [what, place] = kind.variable(index); what == Description::Variable::Formula)
            refuse_if(place);
    refuse_if(formula);
}

}  // namespace

void check_legal_values(const Description& kind) {
    const Draws draws(kind);
    for (const DescribedObservable& observable : kind.observables) {
        check_finite_values(kind, observable.mean, draws);
        for (const auto scatter : {observable.factor, observable.sd}) {
            if (!scatter) continue;
            check_finite_values(kind, *scatter, draws);
            const bool factor = scatter == observable.factor;
            const auto values = draws.evaluated(*scatter);
            for (std::size_t k = 0; k < values.size(); ++k)
                if (values[k] < 0.0 || (factor && values[k] == 0.0))
                    refuse_value(kind, *scatter, draws, k, values[k], "",
                                 factor ? "a factor above 0" : "a deviation, not below 0");
        }
        if (observable.noise != NoiseKind::Event) continue;
        const auto values = draws.evaluated(observable.mean);
        for (std::size_t k = 0; k < values.size(); ++k)
            if (values[k] < -kRounding || values[k] > 1 + kRounding)
                refuse_value(kind, observable.mean, draws, k, values[k], ", which is no probability,",
                             "0 to 1: clip(..., 0, 1), logistic(...) or narrower ranges");
    }
}

}  // namespace puckloop::gap
