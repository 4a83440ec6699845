#include "gap/next_experiment/designs.h"

#include "gap/models/wheel_curve.h"
#include "physics/description/robot_constants.h"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::gap {

namespace {

/// Fills an experiment's only run row by row.
class Table {
  public:
    /// `names`: of the columns, blanks between them; rows that follow give values in this order.
    Table(Experiment& experiment, const char* names) : run_(experiment.runs.emplace_back()) {
        run_.name = run_.file = "design";
        std::istringstream each(names);
        for (std::string name; each >> name;)
            columns_.push_back(&run_.columns[name]);
    }
    /// As many values as columns.
    void row(std::initializer_list<double> values) {
        if (values.size() != columns_.size())
            throw std::logic_error(
                fmt::format("a design's row has {} values for {} columns", values.size(), columns_.size()));
        auto column = columns_.begin();
        for (const double value : values)
            (*column++)->push_back(value);
        ++run_.rows;
    }

  private:
    Run& run_;
    std::vector<std::vector<double>*> columns_;
};

/// A design of each list of parts, what a kind of experiment can be varied in; `fill` writes its rows.
template <class Part>
std::vector<Design> filled(const Experiment& like, void (*fill)(Experiment&, const std::vector<Part>&),
                           const std::vector<std::pair<const char*, std::vector<Part>>>& looks) {
    std::vector<Design> all;
    for (const auto& [what, parts] : looks) {
        Design& design = all.emplace_back(Design{what, {}});
        design.experiment.kind = like.kind;
        design.experiment.nominal = like.nominal;
        design.experiment.instruments = like.instruments;
        fill(design.experiment, parts);
    }
    return all;
}

struct Leg {
    double seconds, left, right;
};

struct Drive {
    std::vector<Leg> legs;
    double heading = 0.0, load = 0.0;
};

/// Rows each 0.1 s of a drive by nominal wheels.
void drive(Experiment& experiment, const std::vector<Drive>& drives) {
    constexpr double kPeriod = 0.1, kMetre = physics::kMetresPerStep, kAxle = physics::kAxleLength;
    const Drive& whole = drives.front();
    Table table(experiment, "t_s cmd_left cmd_right steps_left steps_right x_m y_m theta_rad load_kg order");
    double t = 0, x = 0, y = 0, theta = whole.heading, left = 0, right = 0;
    for (const Leg& leg : whole.legs) {
        const double vl = agenda_speed(leg.left), vr = agenda_speed(leg.right);
        for (int k = 0; k < std::lround(leg.seconds / kPeriod); ++k) {
            table.row({t, leg.left, leg.right, left, right, x, y, theta, whole.load, 1});
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

std::vector<Design> motion(const Experiment& like) {
    const auto square = [](double turn) {
        return repeated(4, {{5, 400, 400}, {1.6, -turn * 200, turn * 200}, {0.5, 0, 0}});
    };
    std::vector<Leg> steps;
    for (double v = 20; v <= 200; v += 20)
        steps.push_back({3, v, v});
    return filled<Drive>(
        like, drive,
        {{"drive straight lines of 0.5 m and 1.5 m, slowly",
          {{{{1, 0, 0}, {12, 300, 300}, {1, 0, 0}, {25, 300, 300}, {1, 0, 0}}}}},
         {"drive straight at 900 steps/s", {{{{1, 0, 0}, {15, 900, 900}, {1, 0, 0}}}}},
         {"drive straight forward and then backward the same way",
          {{{{12, 400, 400}, {1, 0, 0}, {12, -400, -400}, {1, 0, 0}}}}},
         {"drive squares clockwise and counter-clockwise", {{repeated(1, square(1), square(-1))}}},
         {"turn on the spot ten times, both ways",
          {{{{1, 0, 0}, {20, -300, 300}, {1, 0, 0}, {20, 300, -300}, {1, 0, 0}}}}},
         {"drive wide circles both ways beside turns on the spot",
          {{{{15, 300, 400}, {15, 400, 300}, {8, -300, 300}, {8, 300, -300}}}}},
         {"drive 1 m in ten hops and in one go",
          {{repeated(10, {{1.0, 800, 800}, {0.5, 0, 0}}, {{10, 800, 800}, {1, 0, 0}})}}},
         {"reverse twenty times without a stop", {{repeated(10, {{1.0, 300, 300}, {1.0, -300, -300}})}}},
         {"drive the same line with the start turned by 90 degrees",
          {{.legs = {{15, 400, 400}, {1, 0, 0}}, .heading = std::numbers::pi / 2}}},
         {"stand for a minute with the tracker on", {{{{60, 0, 0}}}}},
         {"drive the line with 0.3 kg on the robot", {{.legs = {{15, 400, 400}, {1, 0, 0}}, .load = 0.3}}},
         {"drive at commands from 20 to 200 steps/s in steps", {{steps}}}});
}

struct Wall {
    double low = 0.005, high = 0.08, angle = 0, reflectivity = 1, ambient = 0, motor = 0, velocity = 0,
           hours = 0;
    int sensors = 8;
};

void walls(Experiment& experiment, const std::vector<Wall>& all) {
    Table table(experiment,
                "t_s sensor distance_m angle_rad reflectivity ambient motor_speed velocity object "
                "neighbours battery_v order reading");
    for (const Wall& w : all) {
        double t = 0;
        for (int sensor = 0; sensor < w.sensors; ++sensor)
            for (int k = 0; k < 20; ++k) {
                const double distance = w.low + (w.high - w.low) * k / 19;
                t += 0.1 + w.hours * 3600 / (20 * w.sensors);
                table.row({t, 1.0 * sensor, distance, w.angle, w.reflectivity, w.ambient, w.motor, w.velocity,
                           w.reflectivity == 1 ? 1.0 : 2.0, 0, 3.7, 1, 100});
            }
    }
}

std::vector<Design> proximity(const Experiment& like) {
    return filled<Wall>(
        like, walls,
        {{"all eight sensors before white paper, 5 to 80 mm, in the dark", {Wall{}}},
         {"all eight sensors before a black and a white surface", {{}, {.reflectivity = 0.3}}},
         {"nothing in reach, in the dark and in light",
          {{.low = 0.2, .high = 0.4}, {.low = 0.2, .high = 0.4, .ambient = 1}}},
         {"distances below 10 mm in steps of half a millimetre", {{.low = 0.0, .high = 0.01}}},
         {"walls turned by 35 degrees to either side", {{.angle = 0.6}, {.angle = -0.6}}},
         {"the same distances with the motors on and off", {{}, {.motor = 800}}},
         {"approach and retreat at full speed", {{.velocity = 0.1}, {.velocity = -0.1}}},
         {"one distance for an hour after switching on", {{.low = 0.02, .high = 0.03, .hours = 1}}}});
}

struct Messages {
    double low = 0.2, high = 0.2;
    int senders = 1;
    double rate = 50;
    int receivers = 1;
};

void messages(Experiment& experiment, const std::vector<Messages>& all) {
    Table table(experiment, "t_s distance_m strength bearing_rad true_bearing_rad received receiver emitter "
                            "senders frame_time send_period arrival_rate");
    for (const Messages& m : all) {
        double time = 0;
        for (int r = 1; r <= m.receivers; ++r)
            for (int k = 0; k < 60; ++k)
                table.row({time += 0.02, m.low + (m.high - m.low) * k / 59, 1000, 0, 0, 1, 1.0 * r, 1,
                           1.0 * m.senders, 0.0092, 0.02, m.rate});
    }
}

std::vector<Design> rab(const Experiment& like) {
    return filled<Messages>(
        like, messages,
        {{"turn the receiver through all twelve sectors before one sender at 20 cm", {{.receivers = 12}}},
         {"one sender from contact to 80 cm", {{.low = 0.0, .high = 0.8}}},
         {"one, two and four senders at one place",
          {{}, {.senders = 2, .rate = 100}, {.senders = 4, .rate = 200}}},
         {"one sender at 10, 50 and 150 messages a second", {{.rate = 10}, {}, {.rate = 150}}},
         {"six other pairs of boards at 20 cm", {{.receivers = 6}}}});
}

void edges(Experiment& experiment, const std::vector<double>& speeds) {
    Table table(experiment, "t_s sensor grey grey_rate grey_across speed acceleration reading");
    for (const double speed : speeds)
        for (int sensor = 0; sensor < 3; ++sensor)
            for (int k = 0; k < 60; ++k)
                table.row({0.1 * k, 1.0 * sensor, 0.5 + 0.5 * std::sin(k * 0.3), 60 * std::cos(k * 0.3), 0,
                           k % 40 < 20 ? speed : -speed, k % 10 == 0 && speed > 0.05 ? 1.0 : 0.0, 500});
}

void sounds(Experiment& experiment, const std::vector<double>& windows) {
    Table table(experiment, "t_s mic distance_m angle_rad window amplitude motor_speed level");
    for (const double window : windows)
        for (int mic = 0; mic < 3; ++mic)
            for (int k = 0; k < 40; ++k)
                table.row({0.1 * k, 1.0 * mic, 0.05 + 0.0115 * k, k % 2 == 0 ? 0.0 : 2.0, window, 600,
                           k % 4 < 2 ? 0.0 : 600.0, 100});
}

void faces(Experiment& experiment, const std::vector<double>&) {
    constexpr double kPitch[] = {0.0, 1.5, -1.5};
    Table table(experiment, "t_s pitch_rad roll_rad acceleration motor_speed session ax ay az");
    for (int k = 0; k < 120; ++k)
        table.row({1.0 * k, kPitch[k % 3], k % 5 == 0 ? 1.5 : 0.0, 0, k % 2 == 0 ? 0.0 : 600.0,
                   k < 60 ? 1.0 : 2.0, 2048, 2048, 2848});
}

void frames(Experiment& experiment, const std::vector<double>& loads) {
    Table table(experiment, "seq t_robot_s t_host_s bytes edges i2c_reads load frame_ok shifted");
    for (const double load : loads)
        for (int k = 0; k < 600; ++k)
            table.row({1.0 * k, 0.1 * k, 0.1 * k + 0.007, 84, load > 0 ? 40.0 : 0.0, k % 2 == 0 ? 0.0 : 8.0,
                       load, 1, 0});
}

}  // namespace

std::vector<Design> designs_of(const Experiment& like) {
    switch (like.kind) {
    case Kind::Motion:
        return motion(like);
    case Kind::Proximity:
        return proximity(like);
    case Kind::Rab:
        return rab(like);
    case Kind::Ground:
        return filled<double>(like, edges,
                              {{"cross printed edges slowly, both ways", {0.02}},
                               {"cross printed edges fast, with starts and stops", {0.1}}});
    case Kind::Microphone:
        return filled<double>(like, sounds,
                              {{"each microphone on the axis and turned, 5 to 50 cm", {100.0}},
                               {"the same sound with a quarter of the window", {25.0}}});
    case Kind::Accelerometer:
        return filled<double>(like, faces, {{"all six faces down, motors off and on, in two sessions", {}}});
    case Kind::Timing:
        return filled<double>(like, frames,
                              {{"ten minutes of short frames with and without I2C boards", {0.0}},
                               {"frames of 0x00 and 0xFF with the analogue service on", {0.5}}});
    case Kind::Described:
        break;  // what separates an effect is what its user says
    }
    return {};
}

}  // namespace puckloop::gap
