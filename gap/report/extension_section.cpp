#include "base/pages/chart.h"
#include "base/pages/svg.h"
#include "gap/findings/quantities.h"
#include "gap/report/pictures.h"
#include "gap/report/sections.h"
#include "gap/report/table.h"
#include "gap/residuals/main_covariates.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace puckloop::gap::report {

namespace {

constexpr double kWide = 336, kHigh = 230;    // half an A4 line at 96 a inch
constexpr const char* kExtended = "#008264";  // told apart in black-and-white print too
constexpr double kNinety = 1.645;             // standard deviations of a 90 % band
constexpr std::size_t kMostPictures = 6;      // of tables: the largest

/// Errors of one kind beside each other, each over the largest of its observable.
Picture errors_picture(const Extension& extension) {
    Chart chart("Error of runs that were not fitted", "", "share of the largest");
    chart.level(0);
    std::vector<std::string> names;
    for (const Extended& one : extension.observables) {
        const auto place = static_cast<double>(names.size());
        const double most = std::max({one.before, one.named, one.extended, 1e-300});
        const std::pair<double, const char*> bars[] = {
            {one.before, kBefore}, {one.named, kAfter}, {one.extended, kExtended}};
        double shift = -0.25;
        for (const auto& [error, colour] : bars) {
            chart.bars({place + shift}, 0.11, {0.0}, {error / most}, colour);
            shift += 0.25;
        }
        names.push_back(plain_observable(one.observable));
    }
    chart.categories(names);
    return {chart.svg(kWide, kHigh),
            "Blue: the simulator as it is; orange: with the named causes; green: with "
            "the term without a mechanism."};
}

double size_of_table(const LearntTable& table) {
    const auto [low, high] = std::ranges::minmax_element(table.value);
    return *high - *low;
}

/// Along the first covariate; of two, at three places of the second.
Picture table_picture(const Extended& one, const LearntTable& table) {
    const std::string of = table.times.empty() ? "" : " over " + table.times;
    Chart chart(table.sensor < 0 ? one.quantity.empty() ? one.observable : one.quantity
                                 : fmt::format("{}, sensor {}", one.quantity, table.sensor),
                table.over.front(), fmt::format("{}{}", with_unit("term", one.quantity_unit), of));
    chart.level(0);
    const auto& at = table.at.front();
    if (table.over.size() == 1) {
        std::vector<double> low, high;
        for (std::size_t k = 0; k < at.size(); ++k) {
            low.push_back(table.value[k] - kNinety * table.sd[k]);
            high.push_back(table.value[k] + kNinety * table.sd[k]);
        }
        chart.band(at, low, high, kExtended);
        chart.line(at, table.value, kExtended, "");
        return {chart.svg(kWide, kHigh),
                fmt::format("The learnt term against {}, with its 90 % band.", table.over.front())};
    }
    const auto& other = table.at.back();
    const char* colours[] = {kBefore, kExtended, kAfter};
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t column = k * (other.size() - 1) / 2;
        std::vector<double> line;
        for (std::size_t row = 0; row < at.size(); ++row)
            line.push_back(table.value[row * other.size() + column]);
        chart.line(at, line, colours[k], fmt::format("{} {:.3g}", table.over.back(), other[column]), k == 0);
    }
    return {chart.svg(kWide, kHigh), fmt::format("The learnt term against {}, at three values of {}.",
                                                 table.over.front(), table.over.back())};
}

/// The largest tables, each measured by the largest of its observable.
std::vector<Picture> pictures_of_tables(const Extension& extension) {
    struct Ranked {
        double share;
        const Extended* one;
        const LearntTable* table;
    };
    std::vector<Ranked> all;
    for (const Extended& one : extension.observables) {
        double most = 1e-300;
        for (const LearntTable& table : one.tables)
            if (!table.over.empty()) most = std::max(most, size_of_table(table));
        for (const LearntTable& table : one.tables)
            if (!table.over.empty()) all.push_back({size_of_table(table) / most, &one, &table});
    }
    std::ranges::stable_sort(all, std::ranges::greater{}, &Ranked::share);
    std::vector<Picture> pictures;
    for (std::size_t k = 0; k < std::min(all.size(), kMostPictures); ++k)
        pictures.push_back(table_picture(*all[k].one, *all[k].table));
    return pictures;
}

}  // namespace

std::string extension_section(const Verdict& verdict) {
    const Extension& extension = verdict.extension;
    if (!extension.not_asked.empty()) return {};
    std::string out = "<h2>The model extended by what is unexplained</h2>\n";
    out += fmt::format("<p>{}</p>\n", escaped(extension.sentence));
    Table table({"observable", "unit", "#before", "#named causes", "#with the term", "#ratio",
                 "90 % interval", "#nats", "#better", "overlay"});
    for (const Extended& one : extension.observables)
        table.row({plain_observable(one.observable), unit_cell(one.unit), cell(one.before), cell(one.named),
                   cell(one.extended), cell(one.ratio), range_cell(one.low, one.high), cell(one.gain),
                   fmt::format("{} of {}", one.better, one.blocks),
                   !one.kept              ? "no clear gain"
                   : one.quantity.empty() ? "not written"
                                          : one.quantity},
                  one.kept ? "strong" : "");
    out += table.html() + "<div class=\"pictures\">\n";
    std::vector<Picture> pictures{errors_picture(extension)};
    for (Picture& one : pictures_of_tables(extension))
        pictures.push_back(std::move(one));
    for (const Picture& one : pictures)
        out += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", one.svg, escaped(one.caption));
    return out + "</div>\n";
}

}  // namespace puckloop::gap::report
