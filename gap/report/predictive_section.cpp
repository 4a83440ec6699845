// Posterior-predictive checks: a row of panels for each observable and model.

#include "base/pages/chart.h"
#include "base/pages/svg.h"
#include "gap/report/pictures.h"
#include "gap/report/report.h"
#include "gap/report/sections.h"
#include "gap/report/table.h"
#include "gap/residuals/main_covariates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap::report {

namespace {

constexpr double kPanelWidth = 228, kPanelHeight = 172,
                 kHeading = 24;  // of a panel and of a check's heading, pixels
constexpr std::size_t kColumns = 3;
constexpr const char* kData = "#222222";

/// Do the places stand by themselves, as bars do, or are they points of a course?
bool stands_alone(const PredictiveCurve& curve) {
    return !curve.categories.empty() || curve.name == "marginal law" || curve.name == "spread per run" ||
           curve.name == "autocorrelation";
}

/// Half the distance between two places.
double half_step(const PredictiveCurve& curve) {
    return curve.x.size() > 1 ? std::abs(curve.x[1] - curve.x[0]) / 2 : 0.5;
}

/// Thousandths of a unit where all values are small, so that labels are short.
struct Unit {
    double factor = 1.0;
    std::string name;
};

Unit unit_for(const PredictiveCheck& check) {
    constexpr double kSmallest = 0.1;
    if (check.unit != "m" && check.unit != "rad" && check.unit != "s") return {1.0, check.unit};
    double most = 0.0;
    for (const PredictiveCurve& curve : check.curves)
        if (curve.residual == PredictiveCurve::Residual::Vertical)
            for (const auto* values : {&curve.measured, &curve.low, &curve.high})
                for (const double value : *values)
                    if (std::isfinite(value)) most = std::max(most, std::abs(value));
    return most < kSmallest ? Unit{1e3, "m" + check.unit} : Unit{1.0, check.unit};
}

std::vector<double> times(std::vector<double> values, double factor) {
    for (double& value : values)
        value *= factor;
    return values;
}

std::string panel(const PredictiveCheck& check, const PredictiveCurve& curve) {
    using enum PredictiveCurve::Residual;
    const Unit unit = unit_for(check);
    const bool across = curve.residual == Horizontal, up = curve.residual == Vertical;
    Chart chart(fmt::format("{}, p = {:.{}f}", curve.name, curve.p, curve.p < 0.1 ? 3 : 2),
                across ? with_unit(curve.x_label, unit.name) : curve.x_label,
                up ? with_unit(curve.y_label, unit.name) : curve.y_label);
    const char* colour = check.extended ? kAfter : kBefore;
    const double wide = across ? unit.factor : 1.0, high_by = up ? unit.factor : 1.0;
    const auto x = times(curve.x, wide), measured = times(curve.measured, high_by),
               low = times(curve.low, high_by), high = times(curve.high, high_by);
    if (stands_alone(curve)) {
        chart.bars(x, wide * half_step(curve) * (across ? 1.0 : 0.7), low, high, colour);
    } else {
        chart.band(x, low, high, colour);
        chart.line(x, measured, kData, "");
    }
    chart.dots(x, measured, kData);
    if (curve.name != "marginal law" && curve.name != "spread per run") chart.level(0);
    chart.categories(curve.categories);
    return chart.svg(kPanelWidth, kPanelHeight);
}

double height_of(const PredictiveCheck& check) {
    return kHeading + kPanelHeight * static_cast<double>((check.curves.size() + kColumns - 1) / kColumns);
}

std::string heading(const PredictiveCheck& check, double top) {
    const char* model = check.extended ? "with the named causes" : "the simulator as it is";
    return svg_text(4, top + 16, fmt::format("{}: {}", check.observable, model),
                    "font-size=\"12\" font-weight=\"bold\"") +
           fmt::format(
               "<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"14\" height=\"10\" fill=\"{}\" "
               "fill-opacity=\"0.3\"/>\n<circle cx=\"{:.0f}\" cy=\"{:.0f}\" r=\"2.5\" fill=\"{}\"/>\n",
               2 * kPanelWidth - 70, top + 7, check.extended ? kAfter : kBefore, 3 * kPanelWidth - 72,
               top + 12, kData) +
           svg_text(2 * kPanelWidth - 52, top + 16,
                    fmt::format("90 % of {} replicated data sets", check.replicates), "") +
           svg_text(3 * kPanelWidth - 64, top + 16, "measured", "");
}

std::string picture_of(const std::vector<const PredictiveCheck*>& checks) {
    double top = 0.0;
    std::string body;
    for (const PredictiveCheck* check : checks) {
        body += heading(*check, top);
        for (std::size_t k = 0; k < check->curves.size(); ++k)
            body += svg_moved(kPanelWidth * static_cast<double>(k % kColumns),
                              top + kHeading + kPanelHeight * static_cast<double>(k / kColumns),
                              panel(*check, check->curves[k]));
        top += height_of(*check);
    }
    return svg_document(kColumns * kPanelWidth, top, 10, body);
}

}  // namespace

std::string predictive_svg(const Verdict& verdict) {
    const bool named = std::any_of(verdict.predictive.begin(), verdict.predictive.end(),
                                   [](const PredictiveCheck& check) { return check.extended; });
    std::vector<const PredictiveCheck*> all;
    for (const PredictiveCheck& check : verdict.predictive)
        if (check.extended == named) all.push_back(&check);
    return all.empty() ? std::string() : picture_of(all);
}

std::string predictive_section(const Verdict& verdict) {
    if (verdict.predictive.empty()) return {};
    Table table({"observable", "model", "discrepancy", "#p"});
    std::string figures;
    for (const PredictiveCheck& check : verdict.predictive) {
        for (const PredictiveCurve& curve : check.curves)
            table.row({check.observable, check.extended ? "with the named causes" : "as it is", curve.name,
                       p_cell(curve.p)},
                      curve.p <= 0.05 ? "strong" : "");
        figures += fmt::format("<figure class=\"wide\">{}</figure>\n", picture_of({&check}));
    }
    return "<h2>Does the fitted model make such data?</h2>\n<p>Posterior-predictive check (Gelman, Meng and "
           "Stern 1996): data sets are replicated from the fitted model, with parameters drawn from their "
           "approximate posterior, errors by the fitted law, rounding and clipping. p: share of data sets "
           "that lie as far from the replicates' mean as the measured one does, at the place where each is "
           "farthest. A small p: the model does not make such data. Data that a model was fitted to look a "
           "little better than new data would. Means against covariates and the spread per run, of "
           "what does not add up, count among the structures that are left, with p corrected for their "
           "number; "
           "the other curves are drawn only. A cause can be named for what it gains on runs that were not "
           "fitted while something small is left.</p>\n" +
           figures + table.html();
}

}  // namespace puckloop::gap::report
