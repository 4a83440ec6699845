#include "gap/mission/runs.h"

#include "base/error.h"
#include "base/text/csv.h"
#include "gap/mission/track.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

namespace puckloop::gap::mission {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFewestRuns = 2;  // of a program: one has no spread

const std::vector<Statistic> kStatistics{
    {"score", "1"},         {"speed", "m/s"},        {"turning", "rad/s"}, {"standing", "share"},
    {"nearest robot", "m"}, {"crowd radius", "m"},   {"cruise", "m/s"},    {"veer", "rad/s"},
    {"approach", "m"},      {"swarm's speed", "m/s"}};

struct Header {
    std::optional<std::size_t> program, run, score, condition, failed;
};

Header header_of(const std::string& line, const fs::path& file) {
    const auto cells = csv_cells(line, ',');
    const auto find = [&](std::string_view name) -> std::optional<std::size_t> {
        const auto found = std::find(cells.begin(), cells.end(), name);
        if (found == cells.end()) return std::nullopt;
        return static_cast<std::size_t>(found - cells.begin());
    };
    Header header{find("program"), find("run"), find("score"), find("condition"), find("failed")};
    if (!header.program || !header.run)
        throw InputError(file.string(), "line 1",
                         fmt::format("has no column {}", header.program ? "run" : "program"),
                         "program, run; condition and score if there are any");
    return header;
}

fs::path track_of(const fs::path& folder, const std::string& run, const fs::path& file, int line) {
    for (const fs::path& path : {folder / "runs" / run / "trajectory.csv", folder / (run + ".csv")})
        if (fs::exists(path)) return path;
    throw InputError(
        file.string(), fmt::format("line {}", line), fmt::format("run {} has no track", run),
        fmt::format("runs/{0}/trajectory.csv (an experiment with keep = true leaves it) or {0}.csv", run));
}

void note(std::vector<std::string>& names, const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

}  // namespace

std::vector<const Run*> runs_of(const MissionRuns& all, const std::string& program,
                                const std::string* condition) {
    std::vector<const Run*> runs;
    for (const Run& run : all.runs)
        if (run.program == program && (condition == nullptr || run.condition == *condition))
            runs.push_back(&run);
    return runs;
}

MissionRuns read_mission_runs(const fs::path& folder) {
    const fs::path file = folder / "results.csv";
    std::ifstream in(file);
    if (!in) throw InputError(file.string(), "", "cannot be read", "the runs of a mission, docs/swarm.md");
    MissionRuns all{folder, kStatistics, {}, {}, {}, 0};
    std::string line;
    if (!std::getline(in, line)) throw InputError(file.string(), "line 1", "is empty", "a header");
    const Header header = header_of(line, file);
    for (int number = 2; std::getline(in, line); ++number) {
        if (csv_trimmed(line).empty()) continue;
        const auto cells = csv_cells(line, ',');
        const auto cell = [&](const std::optional<std::size_t>& at) {
            return at && *at < cells.size() ? std::string(cells[*at]) : std::string();
        };
        Run run{cell(header.program), cell(header.condition), cell(header.run), {}};
        if (run.program.empty() || run.name.empty())
            throw InputError(file.string(), fmt::format("line {}", number), "has no program or no run",
                             "both");
        if (run.name.find('/') != std::string::npos)
            throw InputError(file.string(), fmt::format("line {}", number),
                             fmt::format("run {} is a path", run.name), "a name");
        if (!cell(header.failed).empty()) {
            ++all.failed;
            continue;
        }
        double score = std::numeric_limits<double>::quiet_NaN();
        if (const std::string text = cell(header.score); !text.empty() && !csv_number(text, score))
            throw InputError(file.string(), fmt::format("line {}", number),
                             fmt::format("score {} is not a number", text), "a number, or nothing");
        const fs::path track = track_of(folder, run.name, file, number);
        const Behaviour seen = behaviour_of(read_track(track), track);
        run.values = {score,      seen.speed,  seen.turning, seen.standing, seen.nearest,
                      seen.crowd, seen.cruise, seen.veer,    seen.approach, seen.crossing};
        note(all.programs, run.program);
        note(all.conditions, run.condition);
        all.runs.push_back(std::move(run));
    }
    for (const std::string& program : all.programs)
        for (const std::string& condition : all.conditions) {
            const std::size_t runs = runs_of(all, program, &condition).size();
            if (runs < kFewestRuns)
                throw InputError(file.string(), "",
                                 fmt::format("program {}{}{} has {} run{}", program,
                                             condition.empty() ? "" : ", condition ", condition, runs,
                                             runs == 1 ? "" : "s"),
                                 "two or more");
        }
    if (all.runs.empty()) throw InputError(file.string(), "", "has no runs", "one row per run");
    return all;
}

}  // namespace puckloop::gap::mission
