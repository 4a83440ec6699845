#include "benchmark/measures/figure.h"

#include "base/error.h"
#include "base/json.h"
#include "base/quantile.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;

bool has_peer(const Figure& figure) {
    return !figure.peers.empty();
}

ordered_json figure_json(const Figure& figure) {
    const auto [low, high] = std::minmax_element(figure.values.begin(), figure.values.end());
    ordered_json json{{"name", figure.name}, {"unit", figure.unit}, {"median", median(figure.values)},
                      {"lowest", *low},      {"highest", *high},    {"values", figure.values}};
    if (!figure.references.empty())
        json["ratio_to_reference"] = median_ratio(figure.values, figure.references);
    if (has_peer(figure)) {
        json["peer_median"] = median(figure.peers);
        json["ratio_to_peer"] = median_ratio(figure.values, figure.peers);
    }
    if (!figure.note.empty()) json["note"] = figure.note;
    return json;
}

std::string row(const Figure& figure, bool peers) {
    const auto [low, high] = std::minmax_element(figure.values.begin(), figure.values.end());
    std::string text = fmt::format("{:44} {:10.4g} {:10.4g} {:10.4g}  {:18}", figure.name,
                                   median(figure.values), *low, *high, figure.unit);
    text += figure.references.empty()
                ? fmt::format(" {:>12}", "")
                : fmt::format(" {:12.4g}", median_ratio(figure.values, figure.references));
    if (peers && has_peer(figure))
        text +=
            fmt::format(" {:10.4g} {:8.3f}", median(figure.peers), median_ratio(figure.values, figure.peers));
    return text;
}

}  // namespace

double median_ratio(const std::vector<double>& values, const std::vector<double>& others) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(values.size(), others.size()); ++i)
        if (others[i] != 0) ratios.push_back(values[i] / others[i]);
    return ratios.empty() ? 0.0 : median(ratios);
}

std::string figures_table(const std::vector<Figure>& figures, const OtherLoad& load) {
    const bool peers = std::any_of(figures.begin(), figures.end(), has_peer);
    std::string text = fmt::format("{:44} {:>10} {:>10} {:>10}  {:18} {:>12}", "", "median", "lowest",
                                   "highest", "", "/reference");
    if (peers) text += fmt::format(" {:>10} {:>8}", "peer", "/peer");
    text += '\n';
    for (const Figure& figure : figures) {
        if (figure.values.empty()) continue;
        text += row(figure, peers);
        text += '\n';
    }
    for (const Figure& figure : figures)
        if (!figure.note.empty()) text += fmt::format("{}: {}\n", figure.name, figure.note);
    text += "reference: million steps a second of a chain of dependent integer operations, run beside each "
            "measurement\n";
    return text + load.text() + '\n';
}

std::string figures_json(const std::vector<Figure>& figures, const OtherLoad& load) {
    ordered_json list = ordered_json::array();
    for (const Figure& figure : figures)
        if (!figure.values.empty()) list.push_back(figure_json(figure));
    const ordered_json json{{"figures", list},
                            {"other_load",
                             {{"processors", load.processors},
                              {"busy_with_other_work", load.busy},
                              {"load_average_before", load.average_before},
                              {"load_average_after", load.average_after}}}};
    return json.dump(2) + '\n';
}

double median_in(const std::string& text, const std::string& name) {
    const auto json = nlohmann::json::parse(text, nullptr, false);
    const auto list = json.is_object() ? json.value("figures", nlohmann::json()) : json;
    if (list.is_array())
        for (const auto& figure : list)
            if (figure.is_object() && figure.value("name", "") == name && figure.contains("median") &&
                figure["median"].is_number())
                return figure["median"];
    throw RunError(fmt::format("the peer's bench does not print '{}'", name));
}

}  // namespace puckloop::tools
