#include "gap/kinds/description.h"

#include <set>

namespace puckloop::gap {

std::vector<std::size_t> DescribedObservable::formulas() const {
    std::vector<std::size_t> all{mean};
    for (const auto scatter : {factor, sd})
        if (scatter) all.push_back(*scatter);
    return all;
}

std::optional<std::size_t> Description::column(std::string_view named) const {
    for (std::size_t c = 0; c < columns.size(); ++c)
        if (columns[c].name == named) return c;
    return std::nullopt;
}

std::vector<std::string> Description::variables() const {
    std::vector<std::string> names;
    for (const ColumnInfo& column : columns)
        names.emplace_back(column.name);
    for (const DescribedParameter& parameter : parameters)
        names.push_back(parameter.name);
    names.insert(names.end(), formula_names.begin(), formula_names.end());
    return names;
}

std::pair<Description::Variable, std::size_t> Description::variable(std::size_t index) const {
    if (index < columns.size()) return {Variable::Column, index};
    index -= columns.size();
    if (index < parameters.size()) return {Variable::Parameter, index};
    return {Variable::Formula, index - parameters.size()};
}

std::vector<std::size_t> Description::all_used(std::size_t formula) const {
    std::set<std::size_t> used;
    std::set<std::size_t> formulas_seen;
    std::vector<std::size_t> open{formula};
    while (!open.empty()) {
        const std::size_t one = open.back();
        open.pop_back();
        if (!formulas_seen.insert(one).second) continue;
        for (const std::size_t index : formulas[one].formula.used()) {
            used.insert(index);
            const auto [what, place] = variable(index);
            if (what == Variable::Formula) open.push_back(place);
        }
    }
    return {used.begin(), used.end()};
}

std::string Description::full_name(const DescribedParameter& parameter) const {
    return name + "." + parameter.name;
}

}  // namespace puckloop::gap
