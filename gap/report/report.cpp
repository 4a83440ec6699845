#include "gap/report/report.h"

#include "base/pages/svg.h"
#include "gap/findings/quantities.h"
#include "gap/report/pictures.h"
#include "gap/report/sections.h"

#include <fmt/format.h>

#include <map>

namespace puckloop::gap::report {

namespace {

constexpr const char* kStyle = R"css(
@page { size: A4; margin: 15mm; }
body { font-family: "DejaVu Sans", Helvetica, Arial, sans-serif; font-size: 9.5pt; line-height: 1.35; color: #222;
       max-width: 180mm; margin: 8mm auto; }
h1 { font-size: 16pt; margin: 0 0 2mm; }
h2 { font-size: 11.5pt; margin: 7mm 0 2mm; border-bottom: 1px solid #999; break-after: avoid; }
h3 { font-size: 10pt; margin: 4mm 0 1mm; break-after: avoid; }
.about { color: #555; font-size: 8.5pt; margin: 0 0 4mm; }
.verdict { border: 1.5px solid #444; border-left-width: 5mm; padding: 3mm 4mm; margin: 3mm 0; break-inside: avoid; }
.verdict.named { border-color: #005aa0; } .verdict.no_effect { border-color: #777; }
.verdict.cannot_tell { border-color: #aa7800; } .verdict.unexplained { border-color: #c85000; }
.verdict.not_identifiable { border-color: #aa7800; }
.verdict .word { font-size: 13pt; font-weight: bold; }
.verdict p { margin: 1.5mm 0; }
table { border-collapse: collapse; width: 100%; font-size: 8.5pt; margin: 1mm 0 3mm; }
th { text-align: left; border-bottom: 1px solid #444; padding: 0.8mm 2mm 0.8mm 0; font-weight: bold; vertical-align: bottom; }
td { border-bottom: 1px solid #ddd; padding: 0.6mm 2mm 0.6mm 0; vertical-align: top; }
td.n + td:not(.n), th.n + th:not(.n) { padding-left: 3mm; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr { break-inside: avoid; }
.strong { font-weight: bold; }
.faint { color: #888; }
.pictures { display: flex; flex-wrap: wrap; gap: 3mm; }
figure { margin: 0 0 2mm; width: 88mm; break-inside: avoid; }
figure.wide { width: 100%; break-inside: auto; }
figure svg { width: 100%; height: auto; }
figcaption { font-size: 8pt; color: #555; }
ul { margin: 1mm 0; padding-left: 5mm; }
)css";

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
    out += extension_section(verdict);
    out += structure_section(experiment, verdict);
    out += evidence_section(verdict);
    out += reading_section();
    return out + "</body></html>\n";
}

}  // namespace puckloop::gap::report
