// Files of described kinds: TOML, what its tables mean, formulas.

#include "base/error.h"
#include "gap/kinds/read_kind.h"
#include "tests/fuzz/target.h"

#include <cmath>

void puckloop::fuzz::run_input(Input input) {
    const InputFile file(input);
    try {
        const gap::Kind kind = gap::read_kind(file.path());
        const gap::Description& own = *kind.description();
        require(!own.observables.empty() && !own.effects.empty(),
                "a kind with something to measure and to name");
        require(own.variables().size() == own.columns.size() + own.parameters.size() + own.named_formulas,
                "every variable once");
        for (const gap::Effect& effect : own.effects)
            for (const gap::EffectParameter& parameter : effect.parameters)
                require(parameter.low < parameter.high && parameter.prior_sd > 0,
                        "ranges that a fit can use");
        for (std::size_t f = 0; f < own.named_formulas; ++f)
            for (const std::size_t index : own.formulas[f].formula.used())
                if (const auto [what, place] = own.variable(index);
                    what == gap::Description::Variable::Formula)
                    require(place < f, "formulas after those that they have");
    } catch (const InputError& error) {
        require_refusal(error.what(), file.path());
    }
}
