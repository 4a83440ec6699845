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

std::vector<Leg> square(double turn) {
    std::vector<Leg> legs;
    for (int side = 0; side < 4; ++side) {
        legs.push_back({5, 400, 400});
        legs.push_back({1.6, -turn * 200, turn * 200});
        legs.push_back({0.5, 0, 0});
    }
    return legs;
}

void motion(Designs& designs) {
    designs.add("drive straight lines of 0.5 m and 1.5 m, slowly", [](Table& t) {
        drive(t, {{1, 0, 0}, {12, 300, 300}, {1, 0, 0}, {25, 300, 300}, {1, 0, 0}});
    });
    designs.add("drive straight at 900 steps/s", [](Table& t) {
        drive(t, {{1, 0, 0}, {15, 900, 900}, {1, 0, 0}});
    });
    designs.add("drive straight forward and then backward the same way", [](Table& t) {
        drive(t, {{12, 400, 400}, {1, 0, 0}, {12, -400, -400}, {1, 0, 0}});
    });
    designs.add("drive squares clockwise and counter-clockwise", [](Table& t) {
        auto legs = square(1);
        const auto other = square(-1);
        legs.insert(legs.end(), other.begin(), other.end());
        drive(t, legs);
    });
    designs.add("turn on the spot ten times, both ways", [](Table& t) {
        drive(t, {{1, 0, 0}, {20, -300, 300}, {1, 0, 0}, {20, 300, -300}, {1, 0, 0}});
    });
    designs.add("drive wide circles both ways beside turns on the spot", [](Table& t) {
        drive(t, {{15, 300, 400}, {15, 400, 300}, {8, -300, 300}, {8, 300, -300}});
    });
    designs.add("drive 1 m in ten hops and in one go", [](Table& t) {
        std::vector<Leg> legs;
        for (int hop = 0; hop < 10; ++hop) {
            legs.push_back({1.0, 800, 800});
            legs.push_back({0.5, 0, 0});
        }
        legs.push_back({10, 800, 800});
        legs.push_back({1, 0, 0});
        drive(t, legs);
    });
    designs.add("reverse twenty times without a stop", [](Table& t) {
        std::vector<Leg> legs;
        for (int k = 0; k < 20; ++k)
            legs.push_back({1.0, k % 2 == 0 ? 300.0 : -300.0, k % 2 == 0 ? 300.0 : -300.0});
        drive(t, legs);
    });
    designs.add("drive the same line with the start turned by 90 degrees", [](Table& t) {
        drive(t, {{15, 400, 400}, {1, 0, 0}}, std::numbers::pi / 2);
    });
    designs.add("stand for a minute with the tracker on", [](Table& t) { drive(t, {{60, 0, 0}}); });
    designs.add("drive the line with 0.3 kg on the robot", [](Table& t) {
        drive(t, {{15, 400, 400}, {1, 0, 0}}, 0, 0.3);
    });
    designs.add("drive at commands from 20 to 200 steps/s in steps", [](Table& t) {
        std::vector<Leg> legs;
        for (int v = 20; v <= 200; v += 20)
            legs.push_back({3, static_cast<double>(v), static_cast<double>(v)});
        drive(t, legs);
    });
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
    designs.add("all eight sensors before white paper, 5 to 80 mm, in the dark",
                [](Table& t) { wall(t, {}); });
    designs.add("all eight sensors before a black and a white surface", [](Table& t) {
        wall(t, {});
        wall(t, {.reflectivity = 0.3});
    });
    designs.add("nothing in reach, in the dark and in light", [](Table& t) {
        wall(t, {.low = 0.2, .high = 0.4});
        wall(t, {.low = 0.2, .high = 0.4, .ambient = 1});
    });
    designs.add("distances below 10 mm in steps of half a millimetre",
                [](Table& t) { wall(t, {.low = 0.0, .high = 0.01}); });
    designs.add("walls turned by 35 degrees to either side", [](Table& t) {
        wall(t, {.angle = 0.6});
        wall(t, {.angle = -0.6});
    });
    designs.add("the same distances with the motors on and off", [](Table& t) {
        wall(t, {});
        wall(t, {.motor = 800});
    });
    designs.add("approach and retreat at full speed", [](Table& t) {
        wall(t, {.velocity = 0.1});
        wall(t, {.velocity = -0.1});
    });
    designs.add("one distance for an hour after switching on",
                [](Table& t) { wall(t, {.low = 0.02, .high = 0.03, .hours = 1}); });
}

void rab(Designs& designs) {
    const auto messages = [](Table& t, double low, double high, int senders, double rate, int receivers) {
        double time = 0;
        for (int r = 1; r <= receivers; ++r)
            for (int k = 0; k < 60; ++k)
                t.row({{"t_s", time += 0.02},
                       {"distance_m", low + (high - low) * k / 59},
                       {"strength", 1000},
                       {"bearing_rad", 0},
                       {"true_bearing_rad", 0},
                       {"received", 1},
                       {"receiver", static_cast<double>(r)},
                       {"emitter", 1},
                       {"senders", static_cast<double>(senders)},
                       {"frame_time", 0.0092},
                       {"send_period", 0.02},
                       {"arrival_rate", rate}});
    };
    designs.add("turn the receiver through all twelve sectors before one sender at 20 cm",
                [&](Table& t) { messages(t, 0.2, 0.2, 1, 50, 12); });
    designs.add("one sender from contact to 80 cm", [&](Table& t) { messages(t, 0.0, 0.8, 1, 50, 1); });
    designs.add("one, two and four senders at one place", [&](Table& t) {
        messages(t, 0.2, 0.2, 1, 50, 1);
        messages(t, 0.2, 0.2, 2, 100, 1);
        messages(t, 0.2, 0.2, 4, 200, 1);
    });
    designs.add("one sender at 10, 50 and 150 messages a second", [&](Table& t) {
        messages(t, 0.2, 0.2, 1, 10, 1);
        messages(t, 0.2, 0.2, 1, 50, 1);
        messages(t, 0.2, 0.2, 1, 150, 1);
    });
    designs.add("six other pairs of boards at 20 cm", [&](Table& t) { messages(t, 0.2, 0.2, 1, 50, 6); });
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
