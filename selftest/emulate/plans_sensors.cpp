#include "selftest/emulate/plans_sensors.h"

#include "base/random.h"
#include "physics/description/parameters.h"
#include "selftest/emulate/plans.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace puckloop::gap::emulate {

namespace {

constexpr double kSensorDegree = std::numbers::pi / 180;
constexpr const char* kSensorFloor = "[arena]\nsize = [\"6 m\", \"6 m\"]\n";
constexpr double kTurnSpeed = 216, kTurnSeconds = 0.5;  // steps/s: about 30 degrees
constexpr double kLook = 0.8;                           // s at each stop
constexpr double kSpinSpeed = 400, kSpinSeconds = 8;
constexpr double kAwaySpeed = 300;
constexpr double kNearestSpeaker = 0.07,
                 kGrowth = 1.23;  // m from the loudspeaker to the axle, and of each hop
constexpr double kWindow = 100;   // samples, the firmware's
constexpr double kPlannedPlaceQuantum = 1e-4,
                 kPlannedAngleQuantum = 1e-4;  // m and rad, of the measuring table

void then(Act& act, double seconds, double left, double right) {
    double& now = act.commands.back().seconds;  // the last command is the end so far
    act.commands.back().left = left;
    act.commands.back().right = right;
    act.commands.push_back({now + seconds, 0, 0});
}

Act begun(const std::string& part) {
    Act act;
    act.conditions = {{"part", part}};
    act.arena = kSensorFloor;
    act.commands = {{0, 0, 0}};
    then(act, kLook, 0, 0);
    return act;
}

void turn(Act& act, int stops) {
    for (int k = 0; k < stops; ++k) {
        then(act, kTurnSeconds, -kTurnSpeed, kTurnSpeed);
        then(act, kLook, 0, 0);
    }
}

void spin(Act& act, double seconds, double speed) {
    then(act, seconds, -speed, speed);
    then(act, kLook, 0, 0);
}

double rounded(double value, double quantum) {
    return std::round(value / quantum) * quantum;
}

/// It stood and still stands, or drives as evenly as before.
bool at_rest_or_even(const std::vector<Row>& rows, std::size_t k) {
    const bool still = rows[k].left == 0.0 && rows[k].right == 0.0;
    return rows[k].ok && (still ? settled(rows, k) : steady(rows, k));
}

double motor_speed(const Row& r) {
    return (std::abs(r.left) + std::abs(r.right)) / 2;
}

}  // namespace

bool settled(const std::vector<Row>& rows, std::size_t k) {
    constexpr std::size_t kSettledRows = 3;
    if (k < kSettledRows) return false;
    for (std::size_t i = k - kSettledRows; i < k; ++i)
        if (rows[i].left != 0.0 || rows[i].right != 0.0) return false;
    return rows[k].ok;
}

bool steady(const std::vector<Row>& rows, std::size_t k) {
    constexpr std::size_t kSteadyRows = 8;
    if (k < kSteadyRows || rows[k].left == 0.0) return false;
    for (std::size_t i = k - kSteadyRows; i < k; ++i)
        if (rows[i].left != rows[k].left || rows[i].right != rows[k].right) return false;
    return true;
}

std::string speaker_table(double x, double y, double level) {
    return fmt::format("[[speaker]]\nposition = [\"{} m\", \"{} m\"]\nlevel = {}\n", x, y, level);
}

std::vector<Act> microphone_acts(std::uint64_t seed, bool brief) {
    RandomStream random(seed, "loudspeaker on the emulator");
    std::vector<Act> acts;
    const auto add = [&](Act act, double distance) {
        act.arena += speaker_table(0, 0, kSpeakerLevel);
        act.x = distance;
        acts.push_back(std::move(act));
    };
    for (const double distance : {0.08, 0.15, 0.3}) {
        if (brief && distance != 0.15) continue;
        Act act = begun("turn");
        act.heading = 2 * std::numbers::pi * random.uniform();
        turn(act, brief ? 3 : 12);
        add(std::move(act), distance);
    }
    for (const double distance : {0.15, 0.3, 0.5}) {
        if (brief && distance != 0.15) continue;
        Act act = begun("spin");
        act.heading = 2 * std::numbers::pi * random.uniform();
        spin(act, brief ? 2 : kSpinSeconds, kSpinSpeed);
        add(std::move(act), distance);
    }
    // Forwards or backwards, slantwise: every microphone faces the loudspeaker in some way.
    for (int repeat = 0; repeat < (brief ? 1 : 2); ++repeat)
        for (const double facing : {0.0, 50.0, 180.0, 230.0}) {
            if (brief && facing != 0.0) continue;
            Act act = begun("away");
            act.heading = facing * kSensorDegree + 0.2 * (random.uniform() - 0.5);
            const double sense = std::cos(act.heading) > 0 ? 1 : -1;
            double distance = kNearestSpeaker;
            for (int k = 0; k < (brief ? 3 : 10); ++k) {
                const double hop = distance * (kGrowth - 1);
                const double seconds =
                    std::max(1.0, std::round(hop / (kAwaySpeed * kMetresPerStep) * 10)) / 10;
                const double steps = sense * std::round(hop / kMetresPerStep / seconds);
                then(act, seconds, steps, steps);
                then(act, kLook, 0, 0);
                distance += hop;
            }
            add(std::move(act), kNearestSpeaker);
        }
    return acts;
}

WrittenRun microphone_run(const std::vector<Row>& rows) {
    const physics::MicrophoneParameters drawn = physics::Parameters().microphone;
    WrittenRun run;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Row& r = rows[k];
        if (!at_rest_or_even(rows, k)) continue;
        for (std::size_t i = 0; i < physics::kMicrophones; ++i) {
            const double c = std::cos(r.theta), s = std::sin(r.theta);
            const double dx = -(r.x + c * drawn.x[i] - s * drawn.y[i]);
            const double dy = -(r.y + s * drawn.x[i] + c * drawn.y[i]);
            const double off =
                std::remainder(std::atan2(dy, dx) - r.theta - drawn.direction[i], 2 * std::numbers::pi);
            run.column("t_s", "s").values.push_back(r.powered);
            run.column("mic").values.push_back(static_cast<double>(i));
            run.column("distance_m", "m").values.push_back(rounded(std::hypot(dx, dy), kPlannedPlaceQuantum));
            run.column("angle_rad", "rad").values.push_back(rounded(off, kPlannedAngleQuantum));
            run.column("amplitude", "counts").values.push_back(kSpeakerLevel);
            run.column("window").values.push_back(kWindow);
            run.column("motor_speed", "steps/s").values.push_back(motor_speed(r));
            run.column("level", "counts").values.push_back(r.mic[i]);
        }
    }
    return run;
}

std::vector<Act> accelerometer_acts(std::uint64_t seed, bool brief) {
    RandomStream random(seed, "tilts on the emulator");
    std::vector<Act> acts;
    const auto add = [&](Act act, double slope_x, double slope_y) {
        act.heading = 2 * std::numbers::pi * random.uniform();
        act.slope_x = slope_x;
        act.slope_y = slope_y;
        act.shimmed = true;
        acts.push_back(std::move(act));
    };
    for (const double tilt : {0.0, 0.08, -0.15, 0.2}) {
        if (brief && tilt != 0.08) continue;
        Act act = begun("turn");
        turn(act, brief ? 3 : 9);
        add(std::move(act), tilt, tilt > 0 ? 0.05 : 0.0);
    }
    // Slow: the firmware's interrupts shake its steps, which costs 4 counts of y at 250 steps/s and 23 at
    // 800.
    for (const double speed : {80.0, 120.0, 150.0}) {
        if (brief && speed != 120.0) continue;
        Act act = begun("drive");
        for (const double sense : {1.0, -1.0}) {
            then(act, brief ? 2 : 4, sense * speed, sense * speed);
            then(act, kLook, 0, 0);
        }
        add(std::move(act), 0.0, 0.0);
    }
    for (int repeat = 0; repeat < (brief ? 0 : 2); ++repeat) {
        Act act = begun("spin");
        spin(act, kSpinSeconds / 2, 120.0);
        add(std::move(act), 0.0, 0.0);
    }
    return acts;
}

WrittenRun accelerometer_run(const std::vector<Row>& rows, const Act& act) {
    WrittenRun run;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Row& r = rows[k];
        if (!at_rest_or_even(rows, k)) continue;
        const double c = std::cos(r.theta), s = std::sin(r.theta);
        const double gx = std::sin(act.slope_x), gy = std::sin(act.slope_y);
        const double pitch = std::asin(c * gx + s * gy);
        const double roll = std::asin((c * gy - s * gx) / std::cos(pitch));
        run.column("t_s", "s").values.push_back(r.powered);
        run.column("pitch_rad", "rad").values.push_back(rounded(pitch, kPlannedAngleQuantum));
        run.column("roll_rad", "rad").values.push_back(rounded(roll, kPlannedAngleQuantum));
        run.column("motor_speed", "steps/s").values.push_back(motor_speed(r));
        const char* const axes[] = {"ax", "ay", "az"};
        for (std::size_t i = 0; i < 3; ++i)
            run.column(axes[i], "counts").values.push_back(r.acc[i]);
    }
    return run;
}

}  // namespace puckloop::gap::emulate
