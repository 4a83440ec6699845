#include "gap/next_experiment/designs.h"

#include "gap/data/columns.h"
#include "gap/models/wheel_curve.h"
#include "physics/description/robot_constants.h"

#include <cmath>
#include <functional>
#include <initializer_list>
#include <numbers>
#include <utility>

namespace puckloop::gap {

namespace {

using Cell = std::pair<const char*, double>;

/// Fills a run row by row.
class Table {
  public:
    explicit Table(Experiment& experiment) : run_(experiment.runs.emplace_back()) {
        run_.name = run_.file = "design";
    }
    void row(std::initializer_list<Cell> cells) {
        for (const auto& [name, value] : cells) {
            auto& column = run_.columns[name];
            column.resize(run_.rows, NAN);
            column.push_back(value);
        }
        ++run_.rows;
        for (auto& [name, column] : run_.columns)
            column.resize(run_.rows, NAN);
    }

  private:
    Run& run_;
};

class Designs {
  public:
    explicit Designs(const Experiment& like) : like_(like) {}
    void add(const char* what, const std::function<void(Table&)>& fill) {
        Design design{what, {}};
        design.experiment.kind = like_.kind;
        design.experiment.nominal = like_.nominal;
        design.experiment.instruments = like_.instruments;
        Table table(design.experiment);
        fill(table);
        all_.push_back(std::move(design));
    }
    std::vector<Design> take() { return std::move(all_); }

  private:
    const Experiment& like_;
    std::vector<Design> all_;
};

struct Leg {
    double seconds, left, right;
};

/// Rows each 0.1 s of a drive by nominal wheels.
void drive(Table& table, const std::vector<Leg>& legs, double heading = 0.0, double load = 0.0) {
    constexpr double kPeriod = 0.1, kMetre = physics::kMetresPerStep, kAxle = physics::kAxleLength;
    double t = 0, x = 0, y = 0, theta = heading, left = 0, right = 0;
    for (const Leg& leg : legs) {
        const double vl = agenda_speed(leg.left), vr = agenda_speed(leg.right);
        for (int k = 0; k < std::lround(leg.seconds / kPeriod); ++k) {
            table.row({{"t_s", t},
                       {"cmd_left", leg.left},
                       {"cmd_right", leg.right},
                       {"steps_left", left},
                       {"steps_right", right},
                       {"x_m", x},
                       {"y_m", y},
                       {"theta_rad", theta},
                       {"load_kg", load},
                       {"order", 1}});
            const double way = (vl + vr) / 2 * kMetre * kPeriod, turn = (vr - vl) * kMetre / kAxle * kPeriod;
            x += way * std::cos(theta + turn / 2);
            y += way * std::sin(theta + turn / 2);
            theta += turn;
            left += vl * kPeriod;
            right += vr * kPeriod;
            t += kPeriod;
        }
    }
}

std::vector<Leg> repeated(int times, const std::vector<Leg>& legs, const std::vector<Leg>& after = {}) {
    std::vector<Leg> all;
    for (int k = 0; k < times; ++k)
        all.insert(all.end(), legs.begin(), legs.end());
    all.insert(all.end(), after.begin(), after.end());
    return all;
}

void motion(Designs& designs) {
    const auto square = [](double turn) {
        return repeated(4, {{5, 400, 400}, {1.6, -turn * 200, turn * 200}, {0.5, 0, 0}});
    };
    std::vector<Leg> steps;
    for (double v = 20; v <= 200; v += 20)
        steps.push_back({3, v, v});
    struct Drive {
        const char* what;
        std::vector<Leg> legs;
        double heading = 0.0, load = 0.0;
    };
    const Drive drives[] = {
        {"drive straight lines of 0.5 m and 1.5 m, slowly",
         {{1, 0, 0}, {12, 300, 300}, {1, 0, 0}, {25, 300, 300}, {1, 0, 0}}},
        {"drive straight at 900 steps/s", {{1, 0, 0}, {15, 900, 900}, {1, 0, 0}}},
        {"drive straight forward and then backward the same way",
         {{12, 400, 400}, {1, 0, 0}, {12, -400, -400}, {1, 0, 0}}},
        {"drive squares clockwise and counter-clockwise", repeated(1, square(1), square(-1))},
        {"turn on the spot ten times, both ways",
         {{1, 0, 0}, {20, -300, 300}, {1, 0, 0}, {20, 300, -300}, {1, 0, 0}}},
        {"drive wide circles both ways beside turns on the spot",
         {{15, 300, 400}, {15, 400, 300}, {8, -300, 300}, {8, 300, -300}}},
        {"drive 1 m in ten hops and in one go",
         repeated(10, {{1.0, 800, 800}, {0.5, 0, 0}}, {{10, 800, 800}, {1, 0, 0}})},
        {"reverse twenty times without a stop", repeated(10, {{1.0, 300, 300}, {1.0, -300, -300}})},
        {"drive the same line with the start turned by 90 degrees",
         {{15, 400, 400}, {1, 0, 0}},
         std::numbers::pi / 2},
        {"stand for a minute with the tracker on", {{60, 0, 0}}},
        {"drive the line with 0.3 kg on the robot", {{15, 400, 400}, {1, 0, 0}}, 0.0, 0.3},
        {"drive at commands from 20 to 200 steps/s in steps", steps},
    };
    for (const Drive& one : drives)
        designs.add(one.what, [&](Table& t) { drive(t, one.legs, one.heading, one.load); });
}

struct Wall {
    double low = 0.005, high = 0.08, angle = 0, reflectivity = 1, ambient = 0, motor = 0, velocity = 0,
           hours = 0;
    int sensors = 8;
};

void wall(Table& table, const Wall& w) {
    double t = 0;
    for (int sensor = 0; sensor < w.sensors; ++sensor)
        for (int k = 0; k < 20; ++k) {
            const double distance = w.low + (w.high - w.low) * k / 19;
            t += 0.1 + w.hours * 3600 / (20 * w.sensors);
            table.row({{"t_s", t},
                       {"sensor", static_cast<double>(sensor)},
                       {"distance_m", distance},
                       {"angle_rad", w.angle},
                       {"reflectivity", w.reflectivity},
                       {"ambient", w.ambient},
                       {"motor_speed", w.motor},
                       {"velocity", w.velocity},
                       {"object", w.reflectivity == 1 ? 1.0 : 2.0},
                       {"neighbours", 0},
                       {"battery_v", 3.7},
                       {"order", 1},
                       {"reading", 100}});
        }
}

void proximity(Designs& designs) {
    const std::pair<const char*, std::vector<Wall>> looks[] = {
        {"all eight sensors before white paper, 5 to 80 mm, in the dark", {Wall{}}},
        {"all eight sensors before a black and a white surface", {{}, {.reflectivity = 0.3}}},
        {"nothing in reach, in the dark and in light",
         {{.low = 0.2, .high = 0.4}, {.low = 0.2, .high = 0.4, .ambient = 1}}},
        {"distances below 10 mm in steps of half a millimetre", {{.low = 0.0, .high = 0.01}}},
        {"walls turned by 35 degrees to either side", {{.angle = 0.6}, {.angle = -0.6}}},
        {"the same distances with the motors on and off", {{}, {.motor = 800}}},
        {"approach and retreat at full speed", {{.velocity = 0.1}, {.velocity = -0.1}}},
        {"one distance for an hour after switching on", {{.low = 0.02, .high = 0.03, .hours = 1}}},
    };
    for (const auto& [what, walls] : looks)
        designs.add(what, [&](Table& t) {
            for (const Wall& one : walls)
                wall(t, one);
        });
}

struct Messages {
    double low = 0.2, high = 0.2;
    int senders = 1;
    double rate = 50;
    int receivers = 1;
};

void messages(Table& t, const Messages& m) {
    double time = 0;
    for (int r = 1; r <= m.receivers; ++r)
        for (int k = 0; k < 60; ++k)
            t.row({{"t_s", time += 0.02},
                   {"distance_m", m.low + (m.high - m.low) * k / 59},
                   {"strength", 1000},
                   {"bearing_rad", 0},
                   {"true_bearing_rad", 0},
                   {"received", 1},
                   {"receiver", static_cast<double>(r)},
                   {"emitter", 1},
                   {"senders", static_cast<double>(m.senders)},
                   {"frame_time", 0.0092},
                   {"send_period", 0.02},
                   {"arrival_rate", m.rate}});
}

void rab(Designs& designs) {
    const std::pair<const char*, std::vector<Messages>> talks[] = {
        {"turn the receiver through all twelve sectors before one sender at 20 cm", {{.receivers = 12}}},
        {"one sender from contact to 80 cm", {{.low = 0.0, .high = 0.8}}},
        {"one, two and four senders at one place",
         {{}, {.senders = 2, .rate = 100}, {.senders = 4, .rate = 200}}},
        {"one sender at 10, 50 and 150 messages a second", {{.rate = 10}, {}, {.rate = 150}}},
        {"six other pairs of boards at 20 cm", {{.receivers = 6}}},
    };
    for (const auto& [what, parts] : talks)
        designs.add(what, [&](Table& t) {
            for (const Messages& one : parts)
                messages(t, one);
        });
}

void simple(Designs& designs, Kind kind) {
    if (kind == Kind::Ground)
        for (const double speed : {0.02, 0.1})
            designs.add(speed < 0.05 ? "cross printed edges slowly, both ways"
                                     : "cross printed edges fast, with starts and stops",
                        [=](Table& t) {
                            for (int sensor = 0; sensor < 3; ++sensor)
                                for (int k = 0; k < 60; ++k)
                                    t.row({{"t_s", 0.1 * k},
                                           {"sensor", static_cast<double>(sensor)},
                                           {"grey", 0.5 + 0.5 * std::sin(k * 0.3)},
                                           {"grey_rate", 60 * std::cos(k * 0.3)},
                                           {"grey_across", 0},
                                           {"speed", k % 40 < 20 ? speed : -speed},
                                           {"acceleration", k % 10 == 0 && speed > 0.05 ? 1.0 : 0.0},
                                           {"reading", 500}});
                        });
    if (kind == Kind::Microphone)
        for (const double window : {100.0, 25.0})
            designs.add(window > 50 ? "each microphone on the axis and turned, 5 to 50 cm"
                                    : "the same sound with a quarter of the window",
                        [=](Table& t) {
                            for (int mic = 0; mic < 3; ++mic)
                                for (int k = 0; k < 40; ++k)
                                    t.row({{"t_s", 0.1 * k},
                                           {"mic", static_cast<double>(mic)},
                                           {"distance_m", 0.05 + 0.0115 * k},
                                           {"angle_rad", k % 2 == 0 ? 0.0 : 2.0},
                                           {"window", window},
                                           {"amplitude", 600},
                                           {"motor_speed", k % 4 < 2 ? 0.0 : 600.0},
                                           {"level", 100}});
                        });
    if (kind == Kind::Accelerometer)
        designs.add("all six faces down, motors off and on, in two sessions", [](Table& t) {
            for (int k = 0; k < 120; ++k)
                t.row({{"t_s", 1.0 * k},
                       {"pitch_rad", k % 3 == 0   ? 0.0
                                     : k % 3 == 1 ? 1.5
                                                  : -1.5},
                       {"roll_rad", k % 5 == 0 ? 1.5 : 0.0},
                       {"acceleration", 0},
                       {"motor_speed", k % 2 == 0 ? 0.0 : 600.0},
                       {"session", k < 60 ? 1.0 : 2.0},
                       {"ax", 2048},
                       {"ay", 2048},
                       {"az", 2848}});
        });
    if (kind == Kind::Timing)
        for (const double load : {0.0, 0.5})
            designs.add(load > 0 ? "frames of 0x00 and 0xFF with the analogue service on"
                                 : "ten minutes of short frames with and without I2C boards",
                        [=](Table& t) {
                            for (int k = 0; k < 600; ++k)
                                t.row({{"seq", 1.0 * k},
                                       {"t_robot_s", 0.1 * k},
                                       {"t_host_s", 0.1 * k + 0.007},
                                       {"bytes", 84},
                                       {"edges", load > 0 ? 40.0 : 0.0},
                                       {"i2c_reads", k % 2 == 0 ? 0.0 : 8.0},
                                       {"load", load},
                                       {"frame_ok", 1},
                                       {"shifted", 0}});
                        });
}

}  // namespace

std::vector<Design> designs_of(const Experiment& like) {
    Designs designs(like);
    if (like.kind == Kind::Motion)
        motion(designs);
    else if (like.kind == Kind::Proximity)
        proximity(designs);
    else if (like.kind == Kind::Rab)
        rab(designs);
    else
        simple(designs, like.kind);
    return designs.take();
}

}  // namespace puckloop::gap
