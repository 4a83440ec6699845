// puckloop_density: the table of counts that `puckloop bench density` writes, as an experiment of the
// described kind rab_reception (scenarios/kinds).
//
// A table of counts has no single frames: of each class of distance so many rows are made as frames were
// sent, at most kMostFrames with the same share heard, in an order that is drawn. So what frames of one class
// have to do with each other is not in it.

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "base/random.h"
#include "gap/importers/importers.h"
#include "gap/importers/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace puckloop::gap::importers {

namespace {

constexpr const char* kDensityFile = "density.csv";
constexpr const char* kKindFile = "scenarios/kinds/rab_reception.toml";
constexpr int kMostFrames = 100;  // rows of a class of distance
constexpr double kLargestCount = 1e9;
constexpr std::size_t kColumns = 8;  // that are read: setting, robots, bytes, runs, from, to, frames, heard

struct Counted {
    double from = 0.0, to = 0.0, frames = 0.0, heard = 0.0;
};

/// One team under one setting.
struct Team {
    std::string setting;
    double robots = 0.0, bytes = 0.0;
    auto operator<=>(const Team&) const = default;
};

std::vector<double> order_drawn(int frames, int heard, const std::string& name) {
    std::vector<double> received;
    for (int k = 0; k < frames; ++k)
        received.push_back(k < heard ? 1.0 : 0.0);
    RandomStream random(1, "gap/importers/density " + name);
    for (std::size_t k = received.size(); k > 1; --k)
        std::swap(received[k - 1], received[random.below(k)]);
    return received;
}

void add_class(const Counted& one, const std::string& name, WrittenRun& run) {
    const int frames = static_cast<int>(std::min(one.frames, double{kMostFrames}));
    const int heard = static_cast<int>(std::lround(frames * one.heard / one.frames));
    for (const double received : order_drawn(frames, heard, fmt::format("{} {:g}", name, one.from)))
        run.row({{"distance_m", (one.from + one.to) / 2}, {"received", received}});
}

std::vector<std::pair<Team, std::vector<Counted>>> teams_of(const std::filesystem::path& file) {
    const auto rows = read_rows(file, ',');
    std::vector<std::pair<Team, std::vector<Counted>>> teams;
    for (std::size_t k = 1; k < rows.size(); ++k) {  // below the header
        const TextRow& row = rows[k];
        const auto refuse_row = [&](const char* what, const char* expected) {
            throw InputError(file.string(), fmt::format("line {}", row.line), what, expected);
        };
        if (row.cells.size() < kColumns)
            refuse_row("has too few cells", "a table of `puckloop bench density`");
        const auto number = [&](std::size_t cell) { return number_in(file, row, cell); };
        const Team team{row.cells[0], number(1), number(2)};
        const Counted one{number(4), number(5), number(6), number(7)};
        if (!(one.frames >= 0 && one.frames <= kLargestCount && one.heard >= 0 && one.heard <= one.frames))
            refuse_row("frames and heard do not fit", "counts, and no more heard than there were");
        if (!(one.to > one.from)) refuse_row("from_m and to_m do not fit", "the nearer edge first");
        if (teams.empty() || teams.back().first != team) teams.push_back({team, {}});
        if (one.frames > 0) teams.back().second.push_back(one);
    }
    return teams;
}

std::vector<WrittenExperiment> read_density(const std::filesystem::path& folder) {
    WrittenExperiment e;
    e.folder = "rab_reception";
    e.kind_file = shipped_file(kKindFile);
    if (e.kind_file.empty()) throw InputError("", "gap import", fmt::format("there is no {}", kKindFile));
    e.kind = "rab_reception";
    e.title = "range and bearing against density, distance and payload";
    e.robot = "e-pucks with range-and-bearing boards";
    e.description = fmt::format(
        "Counts of `puckloop bench density`: a run is a team of one size and payload under one setting, a "
        "row "
        "is a frame. Of each class of distance at most {} frames, with the share heard and in an order that "
        "is drawn.",
        kMostFrames);
    for (const auto& [team, counted] : teams_of(folder / kDensityFile)) {
        WrittenRun run;
        run.name = fmt::format("team{:02}", e.runs.size() + 1);
        run.conditions = {{"setting", team.setting}};
        run.constants = {{"robots", team.robots}, {"bytes", team.bytes}};
        for (const Counted& one : counted)
            add_class(one, run.name, run);
        if (run.rows() > 0) e.runs.push_back(std::move(run));
    }
    return {e};
}

}  // namespace

const Importer kDensity{"puckloop_density",
                        "frames of range-and-bearing boards that arrive, by robots, payload and distance",
                        kDensityFile, kDensityFile, read_density};

}  // namespace puckloop::gap::importers
