#include "gap/findings/extension.h"
#include "gap/overlay/overlay_parts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace puckloop::gap {

namespace {

std::string numbers(const std::vector<double>& values) {
    std::string text;
    for (const double one : values)
        text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", one);
    return "[" + text + "]";
}

std::string table_toml(const std::string& quantity, const LearntTable& table) {
    std::string text = fmt::format("\n[[extension]]\nadds_to = \"{}\"\n", quantity);
    if (table.sensor >= 0) text += fmt::format("sensor = {}\n", table.sensor);
    if (!table.times.empty()) text += fmt::format("times = \"{}\"\n", table.times);
    if (!table.over.empty()) {
        std::string at;
        for (const auto& one : table.at)
            at += (at.empty() ? "" : ", ") + numbers(one);
        text += fmt::format("over = [\"{}\"]\nat = [{}]\n", fmt::join(table.over, "\", \""), at);
    }
    text += fmt::format("value = {}\n", numbers(table.value));
    if (!table.sd.empty()) text += fmt::format("sd = {}\n", numbers(table.sd));
    if (table.run_spread > 0) text += fmt::format("run_spread = {:.6g}\n", table.run_spread);
    return text;
}

}  // namespace

std::string extension_toml(const Extension& extension) {
    std::string text;
    for (const Extended& one : extension.observables) {
        if (!one.kept || one.quantity.empty()) continue;
        text +=
            fmt::format("\n# Without a mechanism: {} in {}. Error of runs that were not fitted: {:.3g} {} as "
                        "it is, {:.3g} with the\n# named causes, {:.3g} with this.\n",
                        one.quantity, one.quantity_unit, one.before, one.unit, one.named, one.extended);
        if (!one.formula.empty()) text += fmt::format("# Nearly {}\n", one.formula);
        for (const LearntTable& table : one.tables)
            text += table_toml(one.quantity, table);
    }
    return text;
}

}  // namespace puckloop::gap
