#include "gap/report/report.h"

#include "gap/report/pictures.h"
#include "gap/report/sections.h"
#include "gap/report/style.h"
#include "physics/render/svg_canvas.h"

#include <fmt/format.h>

namespace puckloop::gap::report {

namespace {

using physics::escaped;

std::string figures(const std::vector<Picture>& pictures) {
    std::string out = "<div class=\"pictures\">\n";
    for (const Picture& p : pictures)
        out += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", p.svg, escaped(p.caption));
    return out + "</div>\n";
}

/// What sums along a drive are, under their heading; "" for what is a column of the data.
std::string meaning_of(const Experiment& experiment, const std::string& observable) {
    if (experiment.kind != Kind::Motion) return "";
    if (observable == "along")
        return "<p class=\"about\">Way ahead since the run began, summed row by row along the robot's own "
               "heading.</p>\n";
    if (observable == "across")
        return "<p class=\"about\">Way to the left since the run began, summed row by row across the robot's "
               "own heading.</p>\n";
    if (observable == "heading") return "<p class=\"about\">Turn since the run began, to the left.</p>\n";
    if (observable == "x_m" || observable == "y_m")
        return "<p class=\"about\">Place in the room, from where the run began.</p>\n";
    return "";
}

std::string all_pictures(const Experiment& experiment, const Verdict& verdict) {
    std::string out = "<h2>Measured and simulated</h2>\n";
    if (const auto paths = path_pictures(experiment, verdict); !paths.empty()) out += figures(paths);
    for (const Series& series : verdict.series) {
        if (verdict.series.size() > 1)
            out += fmt::format("<h3>{}</h3>\n{}", escaped(series.observable),
                               meaning_of(experiment, series.observable));
        out += figures(pictures_of(experiment, series, verdict.seed));
    }
    return out;
}

}  // namespace

std::string report_html(const Experiment& experiment, const Verdict& verdict) {
    std::string out = fmt::format("<!DOCTYPE html>\n<html lang=\"en\"><head><meta "
                                  "charset=\"utf-8\">\n<title>{}</title>\n<style>{}</style></head>\n"
                                  "<body>\n",
                                  escaped(experiment.title), kStyle);
    out += header_section(experiment, verdict);
    out += next_section(verdict);
    out += verdict_section(verdict);
    out += cautions_section(verdict);
    out += gain_section(verdict);
    out += rerun_section(verdict);
    out += all_pictures(experiment, verdict);
    out += predictive_section(verdict);
    out += parameters_section(verdict);
    out += rivals_section(verdict);
    out += free_form_section(verdict);
    out += structure_section(experiment, verdict);
    out += evidence_section(verdict);
    out += reading_section();
    return out + "</body></html>\n";
}

}  // namespace puckloop::gap::report
