// roh_ir_bearing: bearings from 9 known positions to four infra-red beacons, 200 repeats each. From
// sunglok/TriangulationToolbox, BSD-2; recorded by H. C. Roh (2010).
//
// The detector's heading is 90 degrees at every position. Rows are written beacon by beacon, repeats in
// order, so that the repeats of one bearing stand together: they share its error.

#include "base/error.h"
#include "gap/importers/importers.h"
#include "gap/importers/text_table.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace puckloop::gap::importers {

namespace {

constexpr const char* kPositions = "(X*).csv";
constexpr double kHeading = std::numbers::pi / 2;
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kQuantum = 0.1 * kDegree;

WrittenRun read_roh_run(const std::filesystem::path& file, const std::vector<std::vector<double>>& beacons) {
    double x = 0, y = 0;
    if (std::sscanf(file.filename().c_str(), "(X%lf,Y%lf).csv", &x, &y) != 2)
        throw InputError(file.string(), "", "does not tell the position in its name", "(X1.5,Y3.0).csv");
    const auto table = read_numbers(file, ',', beacons[0].size());
    WrittenRun run;
    run.name = fmt::format("x{}_y{}", x, y);
    run.conditions = {{"x_m", fmt::format("{}", x)}, {"y_m", fmt::format("{}", y)}};
    for (std::size_t b = 0; b < table.size(); ++b) {
        const double dx = beacons[0][b] - x, dy = beacons[1][b] - y;
        const double truth = std::remainder(std::atan2(dy, dx) - kHeading, 2 * std::numbers::pi);
        for (std::size_t i = 0; i < table[b].size(); ++i)
            run.row({{"emitter", static_cast<double>(b + 1)},
                     {"order", static_cast<double>(i)},
                     {"distance_m", std::hypot(dx, dy)},
                     {"true_bearing_rad", truth},
                     {"bearing_rad", table[b][i] * kDegree}});
    }
    return run;
}

std::vector<WrittenExperiment> read_roh_bearing(const std::filesystem::path& folder) {
    const auto beacons = read_numbers(folder / "landmark.csv", ',', 2);
    WrittenExperiment e;
    e.folder = "roh_ir_bearing";
    e.kind = "rab";
    e.title = "bearings to infra-red beacons from 9 positions";
    e.robot = "rotating infra-red detector";
    e.description =
        "200 bearings to each of four beacons at each position; not an e-puck's board but a rotating "
        "detector. Each position is a run; the 200 repeats of a bearing share its error and count as one.";
    e.source = "github.com/sunglok/TriangulationToolbox; Roh 2010";
    e.licence = "BSD-2";
    e.instruments.push_back({"bearing_rad", NAN, NAN, kQuantum});
    for (const auto& file : paths_like(folder, kPositions))
        e.runs.push_back(read_roh_run(file, beacons));
    return {e};
}

}  // namespace

const Importer kRohBearing{"roh_ir_bearing", "bearings to infra-red beacons",
                           "landmark.csv and (X..,Y..).csv", kPositions, read_roh_bearing};

}  // namespace puckloop::gap::importers
