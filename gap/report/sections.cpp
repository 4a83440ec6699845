#include "gap/report/sections.h"

#include "base/pages/svg.h"
#include "gap/findings/quantities.h"
#include "gap/report/pictures.h"
#include "gap/report/table.h"

#include <fmt/format.h>

#include <set>

namespace puckloop::gap::report {

namespace {

std::string paragraph(const std::string& text) {
    return text.empty() ? std::string() : fmt::format("<p>{}</p>\n", escaped(text));
}

/// In the order of Decision.
constexpr const char* kWords[] = {
    "The cause is named", "Cannot tell: two explanations are as good", "No effect found: nothing to gain",
    "Structure remains that nothing in the catalogue explains", "Not identifiable by these data"};

std::string called(const Cause& cause) {
    return fmt::format("{} (effect {})", cause.title, cause.number);
}

}  // namespace

std::string header_section(const Experiment& experiment, const Verdict& verdict) {
    std::string about = fmt::format("{} experiment{}; {} runs, {} rows; seed {}.", kind_name(experiment.kind),
                                    experiment.robot.empty() ? "" : " with " + experiment.robot,
                                    experiment.runs.size(), experiment.rows(), verdict.seed);
    if (!experiment.source.empty()) about += " Data: " + experiment.source;
    if (!experiment.licence.empty()) about += " (" + experiment.licence + ").";
    return fmt::format("<h1>{}</h1>\n<p class=\"about\">{}<br>{}</p>\n", escaped(experiment.title),
                       escaped(about), escaped(experiment.description));
}

std::string verdict_section(const Verdict& verdict) {
    std::string out = fmt::format("<div class=\"verdict {}\">\n<div class=\"word\">{}</div>\n",
                                  decision_name(verdict.decision),
                                  escaped(kWords[static_cast<std::size_t>(verdict.decision)]));
    out += paragraph(verdict.summary);
    std::set<std::string> said{verdict.summary};
    for (const Cause& cause : verdict.causes)
        if (said.insert(cause.sentence).second) out += paragraph(cause.sentence);
    if (verdict.summary.find(verdict.heldout.sentence) == std::string::npos)
        out += paragraph(verdict.heldout.sentence);
    out += paragraph(verdict.confirmation.sentence);
    return out + "</div>\n";
}

std::string cautions_section(const Verdict& verdict) {
    if (verdict.cautions.empty()) return {};
    std::string out = "<h2>Cautions about the data</h2>\n<ul>\n";
    for (const std::string& caution : verdict.cautions)
        out += fmt::format("<li>{}</li>\n", escaped(caution));
    return out + "</ul>\n";
}

std::string gain_section(const Verdict& verdict) {
    const Held& held = verdict.heldout;
    std::string out = "<h2>Gain on runs that were not fitted</h2>\n";
    Table table({"observable", "unit", "#error before", "#error after", "#ratio", "90 % interval"});
    table.row({"all, standardised", "", cell(held.before), cell(held.after), cell(held.ratio),
               range_cell(held.low, held.high)},
              "strong");
    for (const HeldObservable& o : verdict.observables)
        table.row({plain_observable(o.name), unit_cell(o.unit), cell(o.before), cell(o.after), cell(o.ratio),
                   range_cell(o.low, o.high)});
    out += table.html();
    out += paragraph(
        fmt::format("{} of {} held-out runs are better. Log score a row {} before, {} after (gain {} nats a "
                    "row, 90 % {}). {}",
                    held.runs_better, held.runs, cell(held.score_before), cell(held.score_after),
                    cell(held.score_after - held.score_before), range_cell(held.score_low, held.score_high),
                    !held.gain              ? "The data shows no gain; none is claimed."
                    : held.error_may_stay() ? "The data shows a gain; errors are not smaller for sure."
                                            : "The data shows a gain."));
    if (!verdict.observables.empty()) {
        const Picture picture = gain_picture(verdict);
        out += fmt::format("<div class=\"pictures\"><figure>{}<figcaption>{}</figcaption></figure></div>\n",
                           picture.svg, escaped(picture.caption));
    }
    return out;
}

std::string rerun_section(const Verdict& verdict) {
    const Rerun& rerun = verdict.rerun;
    if (!rerun.asked) return {};
    std::string out = "<h2>The extended simulation, run again</h2>\n";
    if (!rerun.not_done.empty()) return out + paragraph("Not run again: " + rerun.not_done + ".");
    Table table({"observable", "unit", "#error before", "#error after", "#ratio"});
    for (const RerunObservable& o : rerun.observables)
        table.row({o.name, unit_cell(o.unit), cell(o.before), cell(o.after), cell(o.after / o.before)});
    out += table.html();
    out += paragraph(fmt::format("The whole robot emulated, firmware in the loop: {} of {} runs or "
                                 "placements a side, {} rows of the measurement compared; first as the "
                                 "simulator is, then with overlay.toml. Measurement noise is in both errors.",
                                 rerun.runs, rerun.of_runs, rerun.rows));
    if (const auto caution = rerun.caution(); !caution.empty()) out += paragraph("Mind: " + caution + ".");
    if (!rerun.left_out.empty())
        out += paragraph(
            fmt::format("Without a counterpart in a run, so left out: {}.", fmt::join(rerun.left_out, ", ")));
    return out;
}

std::string parameters_section(const Verdict& verdict) {
    Table table({"cause", "parameter", "unit", "#simulator", "#fitted", "90 % interval", "goes into"});
    const auto add = [&](const std::string& cause, const FittedParameter& p) {
        const int digits = digits_to_tell(p.low, p.value, p.high);
        table.row({cause, p.name, unit_cell(p.unit), cell(p.neutral), cell(p.value, digits),
                   range_cell(p.low, p.high, digits), p.in_simulator ? "simulator" : "measuring chain"});
    };
    for (const Cause& cause : verdict.causes)
        for (const FittedParameter& p : cause.parameters)
            add(called(cause), p);
    for (const FittedParameter& p : verdict.nuisance)
        add("fitted along", p);
    return table.empty() ? std::string() : "<h2>Parameters</h2>\n" + table.html();
}

std::string rivals_section(const Verdict& verdict) {
    std::string out;
    Table rivals({"instead of", "rival", "#ΔBIC", "what would tell"});
    for (const Rival& rival : verdict.rivals)
        rivals.row({rival.instead_of, called(rival.cause), cell(rival.delta_bic), rival.separated_by});
    if (!rivals.empty())
        out += "<h2>Rivals</h2>\n<p>ΔBIC below 6: the data does not tell the rival from the cause.</p>\n" +
               rivals.html();
    Table next({"#rank", "experiment", "tells between", "#expected information (bits)"});
    for (const Suggestion& s : verdict.suggestions)
        next.row(
            {std::to_string(s.rank), s.what, fmt::format("{}", fmt::join(s.between, ", ")), cell(s.bits)});
    if (!next.empty())
        out +=
            "<h2>What to measure next</h2>\n<p>Those of one rank are as good as each other; what would tell "
            "nothing is left out.</p>\n" +
            next.html();
    return out;
}

std::string free_form_section(const Verdict& verdict) {
    std::string out;
    if (!verdict.nearest.empty()) {
        Table table({"effect", "#no.", "#ΔBIC", "#held-out score (nats)", "in words"});
        for (const Cause& cause : verdict.nearest)
            table.row({cause.name, std::to_string(cause.number), cell(cause.evidence), cell(cause.score_gain),
                       cause.sentence});
        out += "<h2>What came nearest</h2>\n<p>These effects gain something, but not as a cause would, or "
               "less than a correction without any mechanism: they are not named as causes, and the figures "
               "below are those of the simulator without them.</p>\n" +
               table.html();
    }
    Table table({"observable", "#held-out score (nats)", "against", "#share", "shape"});
    for (const FreeForm& form : verdict.free_forms) {
        if (!form.clear) continue;
        std::string observable = plain_observable(form.observable), gain = cell(form.gain);
        if (form.terms.empty()) table.row({observable, gain, "", "", form.shape});
        for (const FreeFormTerm& term : form.terms) {
            table.row({observable, gain, term.over, cell(term.share), term.shape});
            observable = gain = "";
        }
    }
    if (!table.empty())
        out +=
            fmt::format(
                "<h2>Unexplained: the shape of what remains</h2>\n<p>A correction without a mechanism, made "
                "after the named effects: it predicts runs that it did not see better than they do, by "
                "{:.0f} % of all that is gained. It names nothing; what of it a run can take is below.</p>\n",
                100 * verdict.unexplained_share) +
            table.html();
    return out;
}

std::string evidence_section(const Verdict& verdict) {
    Table table({"effect", "#no.", "#ΔBIC", "#held-out score (nats)", "#p", "remark"});
    for (const Tried& t : verdict.tried) {
        const bool chosen = t.remark.starts_with("chosen");
        table.row({t.name, std::to_string(t.number), cell(t.delta_bic), cell(t.score_gain), p_cell(t.p_value),
                   t.remark},
                  chosen               ? "strong"
                  : !(t.delta_bic > 0) ? "faint"
                                       : "");
    }
    return table.empty() ? std::string() : "<h2>Every effect that was tried</h2>\n" + table.html();
}

std::string reading_section() {
    return "<h2>How to read this</h2>\n<p class=\"about\">Before: the simulator as it is, with the nominal "
           "numbers of the experiment. After: with the named causes and the parameters of the table. Held "
           "out: each run was predicted from parameters fitted to other runs. ΔBIC: evidence for the effect "
           "after paying for its parameters; above 6 is clear, below 0 speaks against it. Structure tests "
           "exchange whole blocks of rows or whole runs, so that readings that carry over do not count "
           "twice, and are corrected for their number (Holm).</p>\n";
}

}  // namespace puckloop::gap::report
