// optiodom_diffdrive: a differential-drive robot on circles (both senses) and free paths under motion
// capture. From sousarbarb/optiodom, MIT. A folder a session with `<session>_metadata.csv` (nominal geometry)
// and
// `<session>_run-NN.csv`: t[s], x[m], y[m], theta[rad], right and left wheel counts since the last row. Of
// the 20 rows a second every fourth is kept: counts are summed first, so only resolution in time is lost.

#include "base/error.h"
#include "gap/importers/importers.h"
#include "gap/importers/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace puckloop::gap::importers {

namespace {

/// Numbers of [nominal], by name.
using Geometry = std::map<std::string, double>;

/// Rows "key,value,..."; the diameters stand right, left.
Geometry read_geometry(const std::filesystem::path& file) {
    Geometry g;
    double gear = 0, encoder = 0;
    for (const TextRow& row : read_rows(file, ',')) {
        if (row.cells[0] == "Li") g["robot.axle_length"] = number_in(file, row, 1);
        if (row.cells[0] == "ngear") gear = number_in(file, row, 1);
        if (row.cells[0] == "encRes") encoder = number_in(file, row, 1);
        if (row.cells[0] != "Di") continue;
        g["robot.wheel_radius_right"] = number_in(file, row, 1) / 2;
        g["robot.wheel_radius_left"] = number_in(file, row, 2) / 2;
    }
    g["robot.steps_per_turn"] = gear * encoder;
    if (g.size() < 4 || std::ranges::any_of(g, [](const auto& one) { return !(one.second > 0); }))
        throw InputError(file.string(), "", "lacks the nominal geometry", "rows Li, Di, ngear and encRes");
    g["inverse_friction"] = 0.0;
    return g;
}

constexpr std::size_t kEvery = 4;

std::vector<double> thinned(const std::vector<double>& values) {
    std::vector<double> kept;
    for (std::size_t i = 0; i < values.size(); i += kEvery)
        kept.push_back(values[i]);
    return kept;
}

std::vector<double> summed(std::vector<double> counts) {
    std::partial_sum(counts.begin(), counts.end(), counts.begin());
    return counts;
}

WrittenRun read_optiodom_run(const std::filesystem::path& file, const std::string& session) {
    auto table = read_numbers(file, ',', 6);
    WrittenRun run;
    run.name = file.stem().string();
    run.session = session;
    const auto right = summed(table[4]), left = summed(table[5]);
    const double turned = table[3].back() - table[3].front();
    run.conditions["sense"] = std::fabs(turned) < 8 ? "free" : turned > 0 ? "counter-clockwise" : "clockwise";
    for (std::size_t i = 1; i < table[0].size(); ++i)
        if (table[0][i] <= table[0][i - 1])
            throw InputError(file.string(), fmt::format("row {}", i + 1), "time does not rise",
                             "rising times");
    run.columns = {{"t_s", thinned(table[0])},    {"x_m", thinned(table[1])},
                   {"y_m", thinned(table[2])},    {"theta_rad", thinned(table[3])},
                   {"steps_left", thinned(left)}, {"steps_right", thinned(right)}};
    return run;
}

WrittenExperiment read_part(const std::filesystem::path& folder, const char* part, const char* title) {
    WrittenExperiment e;
    e.folder = fmt::format("optiodom_{}", part);
    e.kind = "motion";
    e.title = title;
    e.robot = "differential-drive robot, 84 mm wheels, 0.2 m axle";
    e.description =
        "Wheel counts are the encoders' (what the wheels did), so commands and latency are not part of this "
        "set. Positions are motion capture. Every fourth of 20 rows a second is kept. Session = one folder "
        "of the set. Geared motors change the speed by 1 m/s2 at most: no tyre slides, so the e-puck's "
        "sliding at each jump of its stepper motors is off.";
    e.source = "github.com/sousarbarb/optiodom";
    e.licence = "MIT";
    for (const auto& session : paths_like(folder / part, "*")) {
        if (!std::filesystem::is_directory(session)) continue;
        const auto metadata = paths_like(session, "*_metadata.csv");
        if (metadata.empty())
            throw InputError(session.string(), "", "has no metadata", "<session>_metadata.csv");
        const Geometry geometry = read_geometry(metadata.front());
        if (e.runs.empty()) e.nominal = geometry;
        if (geometry != e.nominal)
            throw InputError(metadata.front().string(), "", "tells another robot than the sessions before",
                             "one nominal geometry");
        for (const auto& file : paths_like(session, "*_run-*.csv"))
            e.runs.push_back(read_optiodom_run(file, session.filename().string()));
    }
    return e;
}

std::vector<WrittenExperiment> read_optiodom(const std::filesystem::path& folder) {
    std::vector<WrittenExperiment> all{
        read_part(folder, "circular", "circles in both senses under motion capture"),
        read_part(folder, "free", "free drives under motion capture")};
    std::erase_if(all, [](const WrittenExperiment& e) { return e.runs.empty(); });
    if (all.empty())
        throw InputError(folder.string(), "", "has no runs", "circular/<session>/<session>_run-NN.csv");
    return all;
}

}  // namespace

const Importer kOptiodom{
    "optiodom_diffdrive", "wheel counts and motion capture of a differential-drive robot",
    "circular/ or free/ with *_metadata.csv", "@(circular|free)/*/*_metadata.csv", read_optiodom};

}  // namespace puckloop::gap::importers
