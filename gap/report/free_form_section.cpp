// What came nearest where nothing is named, and the free-form correction of what is left.

#include "gap/report/sections.h"
#include "gap/report/table.h"

#include <fmt/format.h>

namespace puckloop::gap::report {

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
                "{:.0f} % of all that is gained. It names nothing and is not part of the overlay.</p>\n",
                100 * verdict.unexplained_share) +
            table.html();
    return out;
}

}  // namespace puckloop::gap::report
