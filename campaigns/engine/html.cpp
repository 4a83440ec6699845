#include "campaigns/engine/html.h"

#include "base/pages/html_page.h"
#include "base/pages/svg.h"
#include "campaigns/engine/findings.h"
#include "campaigns/engine/table.h"
#include "campaigns/jobs/result_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace puckloop::faults {

namespace {

constexpr std::string_view kStyle = R"(
.copy{user-select:all;display:inline-block;min-width:24em}
.heat td{padding:0;text-align:center;font-size:12px} .heat td a{display:block;min-width:22px;line-height:22px;color:inherit;text-decoration:none}
.heat th{font-weight:normal;font-size:12px;white-space:nowrap} .heat thead th{writing-mode:vertical-rl}
tr:target{outline:3px solid var(--strong)}
)";

/// A short sign and a colour for each outcome; the sign serves who cannot see the colours apart.
struct Look {
    Outcome outcome;
    const char* name;
    const char* sign;
    const char* colour;
    const char* meaning;
};
constexpr Look kLooks[] = {
    {Outcome::PuckloopFailed, "p", "!", "#000000",
     "the emulator itself crashed, broke a time bound or threw: the case shows nothing of the robot"},
    {Outcome::NotFired, "n", "-", "#ffffff", "the fault never did anything: the case shows nothing"},
    {Outcome::Crash, "c", "X", "#7b1fa2", "a program or a node ended by itself"},
    {Outcome::ResetLoop, "l", "L", "#ad1457", "a board was reset again and again"},
    {Outcome::Hang, "h", "H", "#c62828", "a sender fell silent for good, or a program computes for ever"},
    {Outcome::Degraded, "d", "D", "#f57c00", "the mission's metric is outside its tolerance"},
    {Outcome::SilentCorruption, "s", "S", "#fbc02d", "nobody noticed, and the robot went elsewhere"},
    {Outcome::Recovered, "r", "r", "#aed581", "there was a pause, and then all went on"},
    {Outcome::Detected, "t", "d", "#81d4fa", "software was given to know; the mission is as good as without"},
    {Outcome::Masked, "m", "m", "#e8f5e9", "nothing of it is seen"}};

const Look& look_of(Outcome outcome) {
    return *std::find_if(std::begin(kLooks), std::end(kLooks),
                         [&](const Look& look) { return look.outcome == outcome; });
}

/// Of several cases in one cell the worst is shown: puckloop failed, crash, then in the order of precedence.
bool worse(Outcome a, Outcome b) {
    const auto rank = [](Outcome outcome) {
        if (outcome == Outcome::NotFired) return 100;
        if (outcome == Outcome::SilentCorruption) return static_cast<int>(Outcome::Degraded) * 2 + 1;
        return static_cast<int>(outcome) * 2;
    };
    return rank(a) < rank(b);
}

struct Spot {
    const CaseResult* worst = nullptr;
    std::size_t cases = 0;
    std::string pruned;
};

/// One sweep: kinds and what else differs down, places across, in the order of the cases.
std::string heat_map(const Sweep& plan, const Results& results) {
    const std::string& sweep = plan.name;
    const bool counts =
        std::any_of(plan.over.begin(), plan.over.end(), [](const auto& key) { return key.first == "count"; });
    std::vector<std::string> rows, places;
    std::map<std::pair<std::string, std::string>, Spot> spots;
    const auto spot = [&](const Case& one) -> Spot& {
        std::string row = kind_and_link(one.faults[0]);
        for (const auto& [key, value] : one.faults[0].items())
            if (key != "kind" && key != "link" && key != "node" && key != "from" && key != "begin" &&
                (key != "count" || counts))
                row += fmt::format(" {}={}", key, value_text(value));
        if (std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
        if (std::find(places.begin(), places.end(), one.place) == places.end()) places.push_back(one.place);
        return spots[{row, one.place}];
    };
    std::map<int, std::pair<const Case*, const CaseResult*>> all;
    for (const Case& one : results.pruned)
        if (one.sweep == sweep && one.phase == "single") all[one.id] = {&one, nullptr};
    for (const CaseResult& result : results.results)
        if (result.one.sweep == sweep && result.one.phase == "single")
            all[result.one.id] = {&result.one, &result};
    for (const auto& [id, entry] : all) {
        Spot& here = spot(*entry.first);
        if (entry.second == nullptr) {
            here.pruned = entry.first->pruned;
            continue;
        }
        ++here.cases;
        if (here.worst == nullptr || worse(entry.second->verdict.outcome, here.worst->verdict.outcome))
            here.worst = entry.second;
    }
    std::string html = fmt::format(
        "<h3>{}</h3><div class=wide><table class=heat aria-label=\"{}: fault by place\"><thead><tr><td></td>",
        escaped(sweep), escaped(sweep));
    for (const std::string& place : places)
        html += fmt::format("<th scope=col>{}</th>", escaped(place));
    html += "</tr></thead>\n";
    for (const std::string& row : rows) {
        html += fmt::format("<tr><th scope=row>{}</th>", escaped(row));
        for (const std::string& place : places) {
            const auto found = spots.find({row, place});
            if (found == spots.end())
                html += "<td></td>";
            else if (found->second.worst == nullptr)
                html += fmt::format("<td title=\"pruned: {}\">&middot;</td>", escaped(found->second.pruned));
            else {
                const CaseResult& worst = *found->second.worst;
                const Look& look = look_of(worst.verdict.outcome);
                const std::string what = fmt::format(
                    "case {}: {}{}{}{}", worst.one.id, name_of(worst.verdict.outcome),
                    found->second.cases > 1 ? fmt::format(", worst of {}", found->second.cases) : "",
                    worst.verdict.detail.empty() ? "" : ": ", worst.verdict.detail);
                html += fmt::format(
                    "<td class={0}><a href=\"#case{1}\" title=\"{2}\" aria-label=\"{2}\">{3}</a></td>",
                    look.name, worst.one.id, escaped(what), look.sign);
            }
        }
        html += "</tr>\n";
    }
    return html + "</table></div>\n";
}

std::string findings_html(const Results& results) {
    std::string html = "<h2>Findings</h2>\n";
    const std::vector<Finding> findings = findings_of(results.results);
    if (findings.empty()) return html + "<p>None.</p>\n";
    html +=
        "<table><tr><th>outcome</th><th>faults</th><th>what was seen</th><th>cases</th><th>smallest set that "
        "causes it</th><th>replay</th></tr>\n";
    for (const Cause& cause : causes_of(findings)) {
        html += fmt::format("<tr><th colspan=6 scope=rowgroup>{}: {} findings, {} cases</th></tr>\n",
                            escaped(cause.what), cause.findings.size(), cause.cases);
        for (const Finding* finding : cause.findings) {
            const CaseResult& smallest = *finding->smallest;
            html += fmt::format(
                "<tr><td class={}>{}</td><td>{}</td><td>{}</td><td>{}</td><td><code>{}</code></td>"
                "<td><code class=copy>{}</code></td></tr>\n",
                look_of(finding->outcome).name, name_of(finding->outcome), escaped(finding->faults),
                escaped(smallest.verdict.detail), finding->cases.size(),
                escaped(in_one_line(smallest.one.faults)),
                escaped(replay_command_anywhere(results, smallest.one.id)));
        }
    }
    return html + "</table>\n";
}

/// How a case is named in the table: with a link to its page where reports are served.
std::string case_name(const CaseResult& result, const PageOfCase& page) {
    const std::string link = page ? page(result.one) : std::string();
    return link.empty() ? std::to_string(result.one.id)
                        : fmt::format("<a href=\"{}\">{}</a>", escaped(link), result.one.id);
}

std::string cases_html(const Results& results, const PageOfCase& page) {
    std::string html =
        fmt::format(
            "<h2>Cases</h2>\n<p>Any of them runs again with its number at the end of a replay command. "
            "{}</p>\n",
            page ? "A number opens the case in the viewer, where its first fault begins."
                 : fmt::format("<code>puckloop view {}</code> serves this page with numbers that open "
                               "their case in the viewer.",
                               escaped(results.out.string()))) +
        "<table><tr><th>case</th><th>phase</th><th>faults</th><th>seed</th><th>outcome</th>"
        "<th>fired</th><th>recovery, s</th><th>departure, m</th><th>what was seen</th></tr>\n";
    for (const CaseResult& result : results.results)
        html +=
            fmt::format("<tr id=case{0}><td>{10}</td><td>{1}</td><td>{2}</td><td>{3}</td><td "
                        "class={4}>{5}</td><td>{6}</td>"
                        "<td>{7}</td><td>{8:.4f}</td><td>{9}</td></tr>\n",
                        result.one.id, result.one.phase, escaped(in_one_line(result.one.faults)),
                        result.one.seed, look_of(result.verdict.outcome).name,
                        name_of(result.verdict.outcome), fmt::join(result.verdict.fired, "+"),
                        result.verdict.recovery_s ? fmt::format("{:.3f}", *result.verdict.recovery_s) : "",
                        result.verdict.departure_m, escaped(result.verdict.detail), case_name(result, page));
    html += "</table>\n";
    if (results.pruned.empty()) return html;
    html += "<h2>Pruned</h2>\n<table><tr><th>case</th><th>faults</th><th>why</th></tr>\n";
    for (const Case& one : results.pruned)
        html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", one.id,
                            escaped(in_one_line(one.faults)), escaped(one.pruned));
    return html + "</table>\n";
}

/// What was run.
std::string subject(const Campaign& campaign) {
    std::string text = "Scenario " + campaign.scenario.string();
    for (const std::string& firmware : campaign.firmware)
        text += ", " + firmware;
    if (!campaign.program.empty()) text += fmt::format(", program {}", fmt::join(campaign.program, " "));
    if (campaign.duration) text += fmt::format(", {:g} s of simulated time", *campaign.duration);
    return text;
}

}  // namespace

std::string html_text(const Results& results, const PageOfCase& page) {
    std::string style(kStyle);
    for (const Look& look : kLooks)
        style += fmt::format(".{}{{background:{};color:{}}}\n", look.name, look.colour,
                             std::string_view("pclh").find(look.name[0]) != std::string_view::npos ? "#fff"
                                                                                                   : "#222");
    const std::string title = "Fault campaign " + results.campaign.file.filename().string();
    std::string html = html_head(title, style);
    html += fmt::format("<h1>{}</h1>\n<p>{}. Each case is one run with one or two faults, "
                        "compared with a nominal "
                        "run that has none. Exact definitions of the outcomes are in docs/faults.md.</p>\n"
                        "<table><tr><th>outcome</th><th>sign</th><th>cases</th><th>what it means</th></tr>\n",
                        escaped(title), escaped(subject(results.campaign)));
    for (const Look& look : kLooks) {
        const auto count =
            std::count_if(results.results.begin(), results.results.end(),
                          [&](const CaseResult& result) { return result.verdict.outcome == look.outcome; });
        html += fmt::format("<tr><td class={}>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", look.name,
                            name_of(look.outcome), look.sign, count, look.meaning);
    }
    html += fmt::format(
        "<tr><td>pruned</td><td>&middot;</td><td>{}</td><td>not run: the nominal run has nothing that "
        "the fault could act on, or the case is not in the sample</td></tr></table>\n",
        results.pruned.size());
    html += findings_html(results) + "<h2>Where and what</h2>\n<p>Single faults: what was done down, where "
                                     "or when across. A cell leads to "
                                     "its case.</p>\n";
    for (const Sweep& sweep : results.campaign.sweeps)
        html += heat_map(sweep, results);
    return html + cases_html(results, page) + "</body></html>\n";
}

void write_html(const Results& results) {
    jobs::write_whole(results.out / "report.html", html_text(results));
}

}  // namespace puckloop::faults
