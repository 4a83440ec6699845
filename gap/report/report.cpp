#include "gap/report/report.h"

#include "gap/report/pictures.h"
#include "gap/report/sections.h"
#include "gap/report/style.h"
#include "physics/render/svg_canvas.h"

#include <fmt/format.h>

#include <map>

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
    static const std::map<std::string, const char*> kMeaning{
        {"along", "Way ahead since the run began, summed row by row along the robot's own heading."},
        {"across", "Way to the left since the run began, summed row by row across the robot's own heading."},
        {"heading", "Turn since the run began, to the left."},
        {"x_m", "Place in the room, from where the run began."},
        {"y_m", "Place in the room, from where the run began."}};
    const auto meaning = kMeaning.find(observable);
    if (experiment.kind != Kind::Motion || meaning == kMeaning.end()) return "";
    return fmt::format("<p class=\"about\">{}</p>\n", meaning->second);
}

std::string all_pictures(const Experiment& experiment, const Verdict& verdict) {
    std::string out = "<h2>Measured and simulated</h2>\n";
    if (const auto paths = path_pictures(experiment, verdict); !paths.empty()) out += figures(paths);
    for (const Series& series : verdict.series) {
        if (verdict.series.size() > 1)
            out += fmt::format("<h3>{}</h3>\n{}", escaped(plain_observable(series.observable)),
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
