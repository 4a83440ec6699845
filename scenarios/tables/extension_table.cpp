#include "scenarios/tables/extension_table.h"

#include <fmt/format.h>

namespace puckloop::scenarios {

physics::ExtensionTerm read_extension(const std::string& file, const TomlValue& table) {
    constexpr int kMostSensors = 100;  // far beyond any quantity's
    Reader reader(file, "extension", table);
    physics::ExtensionTerm term;
    term.adds_to = reader.text("adds_to");
    term.sensor = static_cast<int>(reader.integer("sensor", -1, 0, kMostSensors));
    term.times = reader.text("times", "");
    const auto over = reader.texts("over");
    const auto at = reader.bare_number_lists("at");
    if (over.size() != at.size())
        reader.fail("at", fmt::format("{} lists of places for {} covariates", at.size(), over.size()),
                    "one list per covariate of over, such as [[0, 0.1, 0.2]]");
    for (std::size_t k = 0; k < over.size(); ++k)
        term.over.push_back({over[k], at[k]});
    term.value = reader.bare_numbers("value");
    term.sd = reader.bare_numbers("sd");
    term.run_spread = reader.quantity("run_spread", Dimension::Number, 0.0);
    reader.finish();
    if (const auto wrong = physics::problem_of(term))
        reader.fail(wrong->key, wrong->problem, wrong->expected);
    return term;
}

}  // namespace puckloop::scenarios
