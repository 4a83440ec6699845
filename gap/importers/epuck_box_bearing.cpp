// epuck1_box_bearing: an e-puck 1 beside a box, turned on the spot in steps of 10 degrees; eight proximity
// sensors, each value the mean of 20 reads. From clamesc/ePuck-Box-Pushing, GPL-3.
//
// Assumed, because the set does not say it: 1. the box's face is flat, wider than the robot and touches the
// body (the simulator's radius from the axle's middle; sensors at saturation over 70 degrees say it is
// near). 2. At turn 0 it stands straight behind and the robot turns clockwise: the readings say so (sensors 3
// and 4 are highest, then 2, 1, 0, 7, ...). 3. Sensors sit where the simulator has them. 4. A sensor that
// looks away from the face, or whose line meets it beyond 12 cm, sees nothing.

#include "gap/importers/importers.h"
#include "gap/importers/text_table.h"
#include "physics/description/parameters.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace puckloop::gap::importers {

namespace {

constexpr const char* kBearingFile = "proximity_by_turn.csv";
constexpr double kReach = 0.12;   // m, the simulator's reach of a proximity sensor
constexpr double kNothing = 1.0;  // m, written where a sensor sees nothing
constexpr double kBoxDegree = std::numbers::pi / 180;
constexpr int kSensors = 8;

/// Distance along a sensor's axis to the face, and the angle of incidence (signed).
std::pair<double, double> seen(const physics::Parameters& p, std::size_t sensor, double towards_box) {
    const double direction = p.proximity.direction[sensor];
    const double incidence = std::remainder(direction - towards_box, 2 * std::numbers::pi);
    const double along =
        p.proximity.x[sensor] * std::cos(towards_box) + p.proximity.y[sensor] * std::sin(towards_box);
    const double facing = std::cos(incidence);
    const double distance = facing > 0 ? (p.robot.radius - along) / facing : kNothing;
    if (facing <= 0 || distance > kReach) return {kNothing, 0.0};
    return {distance, incidence};
}

std::vector<WrittenExperiment> read_epuck_box_bearing(const std::filesystem::path& folder) {
    const auto table = read_numbers(folder / kBearingFile, ',', kSensors + 1, 1);
    const physics::Parameters simulator;
    WrittenExperiment e;
    e.folder = "epuck1_box_bearing";
    e.kind = "proximity";
    e.title = "e-puck 1 beside a box, turned on the spot";
    e.robot = "e-puck 1";
    e.description =
        "36 steps of 10 degrees, each value the mean of 20 reads. The distance to the box is not given: "
        "taken is a flat face that touches the body, so amplitude, origin and distance cannot be told apart. "
        "One sweep; each sensor is written as a run, held-out runs are other sensors of the same sweep.";
    e.source = "github.com/clamesc/ePuck-Box-Pushing";
    e.licence = "GPL-3";
    e.assumed = {"distance_m"};
    for (std::size_t s = 0; s < kSensors; ++s) {
        WrittenRun run;
        run.name = fmt::format("ps{}", s);
        run.constants["sensor"] = static_cast<double>(s);
        for (std::size_t i = 0; i < table[0].size(); ++i) {
            const auto [distance, angle] = seen(simulator, s, std::numbers::pi + table[0][i] * kBoxDegree);
            run.row({{"order", static_cast<double>(i)},
                     {"distance_m", distance},
                     {"angle_rad", angle},
                     {"reading", table[s + 1][i]}});
        }
        e.runs.push_back(run);
    }
    return {e};
}

}  // namespace

const Importer kEpuckBoxBearing{"epuck1_box_bearing", "e-puck 1 proximity sensors beside a box, by turn",
                                kBearingFile, kBearingFile, read_epuck_box_bearing};

}  // namespace puckloop::gap::importers
