// Odometry and motion: what the tracker saw against what the motors did. A run is compared as three sums over
// its rows: way along the heading, way across it, heading. The tracker's own heading turns its steps into
// along and across, so an error of heading does not spread into the other two; what its noise adds to them is
// predicted, as far as the wheels' heading can be trusted (motion_path.h). With counters and commands
// both recorded, the counters are compared with the commands as well.
//
// Deviations from the world model: 1. the wheel follows its motor at once, but for the loss a start or stop
// costs at friction mu. 2. Between rows speed is even. 3. No contacts with things.

#include "gap/clean/quantum.h"
#include "gap/models/gravity.h"
#include "gap/models/model_of.h"
#include "gap/models/motion_path.h"
#include "gap/models/rows.h"
#include "gap/models/wheel_moments.h"
#include "physics/description/parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>
#include <span>

namespace puckloop::gap {

namespace {

constexpr double kStill = 1e-6;     // steps: less than this between rows is standing
constexpr double kSlip = 4;         // steps that a motor loses at a time: its coils' pattern repeats
constexpr double kLateStep = 0.25;  // a step is counted when it is half done or over: 0 to kMostLateStep
constexpr double kMostLateStep = 0.5;
constexpr double kOpenSteps = 0.6;  // of a wheel, each time its speed changes: the timer's phase
constexpr double kOpenSlip = 0.2;   // share of the way lost to sliding that no formula gives
constexpr double kSameTime = 1e-6;  // s
constexpr double kLossDoubt = 0.1;  // of the steps that a lost command costs: when it was sent, when the next
constexpr double kStray = 1e-3, kStraySteps = 50;  // jumps of a counter that nothing explains: of rows, steps
constexpr double kCounterSd = 3.0;                 // steps: whole steps, and when a row was taken
constexpr double kSpan = 100.0;                    // s: wheels that show the heading of a whole run
constexpr double kShortestSpan = 0.02, kLongestSpan = 1000.0;  // s: they show nothing, everything
constexpr double kSpanWidth = 3.0;                             // ln s
constexpr double kSmallAngle = 1e-2;  // rad: below, two terms of a series do for sine and cosine
constexpr double kDoubt = 2e-3;       // rad: of a run's heading as a whole
constexpr double kLeastDoubt = 1e-5, kMostDoubt = 0.2, kDoubtWidth = 3.0;

constexpr std::pair<const char*, const char*> kWheelColumns[] = {{"steps_left", "cmd_left"},
                                                                 {"steps_right", "cmd_right"}};

/// Beside the simulator's: how the robot gets its commands, and what looks at it.
struct MotionNumbers : physics::Parameters {
    double agenda = 1.0;  ///< 0: the project's own firmware; read before the fit, as start_loss
    double start_loss = 0.0, scale = 0.0, mismatch = 0.0, friction = 1 / contact.mu, latency = 0.0,
           drop = 0.0, burst = 0.0, marker_x = 0.0, marker_y = 0.0, marker_angle = 0.0, delay = 0.0,
           heading_drift = 0.0, heading_span = std::log(kSpan), heading_doubt = std::log(kDoubt),
           late_step = kLateStep;

    /// Chance to lose a command after a lost one.
    double again() const { return drop + burst * (1 - drop); }
    /// m of way for a step of the left wheel.
    double metre() const { return 2 * std::numbers::pi * robot.wheel_radius_left / robot.steps_per_turn; }
};

class MotionModel final : public ModelOf<MotionNumbers> {
  public:
    MotionModel(const Experiment& experiment, MotionView view) : view_(view) {
        const Rows rows(experiment, "", {"t_s", "x_m", "y_m", "theta_rad"});
        gather(experiment, rows);
        declare_all();
        apply_nominal(experiment);
        const auto mu = experiment.nominal.find("contact.mu");
        if (mu != experiment.nominal.end() && !experiment.nominal.contains("inverse_friction"))
            parameter("inverse_friction").neutral = 1 / mu->second;
        // Turning mixes the tracker's noise of along and across: their sums wander.
        if (!room()) observables_[0].turn = observables_[1].turn = turns();
        for (std::size_t o = 0; exact_ && !counted_ && o < 3; ++o)
            if (o != 1 || room()) observables_[o].jolt = jolts(o);
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        const MotionNumbers now = numbers(v);
        out.resize(observables_.size());
        const std::size_t n = observables_[0].y.size();
        const bool noisy = now.push.rate > 0 || (!counted_ && now.drop > 0);
        for (std::size_t o = 0; o < 3; ++o) {
            Predicted& p = out[o];
            p.mean.resize(n);
            p.jolt.assign(now.robot.step_loss_speed > 0 && (o != 1 || room()) ? n : 0, 0.0);
            p.lapse.assign(noisy ? n : 0, 0.0);
            p.lapse_scale.assign(noisy ? n : 0, 0.0);
        }
        for (std::size_t o = room() ? 0 : 1; o < 2; ++o) {
            out[o].lever.resize(n);
            out[o].lever_sd = std::exp(now.heading_doubt);
        }
        std::size_t first = 0;
        const double late = now.delay + (counted_ ? 0.0 : now.latency);
        for (const Path& path : paths_) {
            drive(now, path, late, first, out);
            first += path.time.size();
        }
        if (counted_) predict_counters(now, out);
    }

    WheelRows wheels(const std::vector<double>& v) const override {
        const MotionNumbers now = numbers(v);
        const double metre = nominal().metre(), late = now.delay + (counted_ ? 0.0 : now.latency);
        WheelRows rows;
        rows.quantum = has_counters_ ? metre : 0.0;
        for (const Path& path : paths_) {
            CurveReader left(path.wheel[0]), right(path.wheel[1]);
            std::array<double, 2> last{};
            for (std::size_t i = 0; i < path.time.size(); ++i) {
                const double time = path.time[i] - late;
                const std::array<double, 2> steps{left.at(time), right.at(time)};
                rows.left.push_back(i == 0 ? 0.0 : (steps[0] - last[0]) * metre);
                rows.right.push_back(i == 0 ? 0.0 : (steps[1] - last[1]) * metre);
                rows.time.push_back(path.time[i]);
                last = steps;
            }
        }
        return rows;
    }

    std::vector<WheelMoment> wheel_moments(const std::vector<double>& v) const override {
        const MotionNumbers now = numbers(v), as_stated = nominal();
        const double late = now.delay + (counted_ ? 0.0 : now.latency);
        std::vector<WheelMoment> moments;
        std::uint32_t first = 0;
        for (const Path& path : paths_) {
            add_wheel_moments(path, late, as_stated.metre(), as_stated.robot, first, moments);
            first += static_cast<std::uint32_t>(path.time.size());
        }
        return moments;
    }

    /// A dead band begins between the fastest speed that moved nothing and the next one.
    std::vector<double> starts(std::string_view parameter) const override {
        if (parameter != "robot.deadband") return {};
        std::map<double, std::array<double, 2>> moves;  // speed -> metres asked for, metres seen
        const MotionNumbers values = nominal();
        const double metre = values.metre(), arm = values.robot.axle_length / 2;
        std::size_t row = 0;
        for (const Path& path : paths_) {
            std::array<CurveReader, 2> pacer{CurveReader(path.paced(0)), CurveReader(path.paced(1))};
            std::array<double, 2> last{pacer[0].at(path.time[0]), pacer[1].at(path.time[0])};
            for (std::size_t i = 1; i < path.time.size(); ++i)
                for (std::size_t w = 0; w < 2; ++w) {
                    const double way = along_[row + i] - along_[row + i - 1],
                                 turn = observables_[2].y[row + i] - observables_[2].y[row + i - 1];
                    const double steps = pacer[w].at(path.time[i]), asked = steps - last[w];
                    last[w] = steps;
                    const double span = path.time[i] - path.time[i - 1];
                    const double speed = std::abs(asked) / std::max(span, kSameTime);
                    const bool starts = !counted_ && values.start_loss > 0 &&
                                        !settled(path, path.time[i - 1], span);  // not at one speed
                    if (speed < 1 || starts) continue;
                    auto& sums = moves[std::round(speed * 10) / 10];
                    sums[0] += std::abs(asked) * metre;
                    sums[1] += std::copysign(1.0, asked) * (way + (w == 0 ? -arm : arm) * turn);
                }
            row += path.time.size();
        }
        // Every split of the speeds in those that move nothing and the others: which fits best?
        double misfit = 0.0, least = 0.0, best = 0.0;
        for (auto move = moves.begin(); move != moves.end(); ++move) {
            const auto& [asked, seen] = move->second;
            misfit += seen * seen - (seen - asked) * (seen - asked);
            if (misfit >= least || std::next(move) == moves.end()) continue;
            least = misfit;
            best = (move->first + std::next(move)->first) / 2;
        }
        return best > 0 ? std::vector{best} : std::vector<double>{};
    }

  private:
    bool room() const { return view_ == MotionView::Room; }

    /// Of a variance along the robot: the share that an observable sees.
    double share_along(const Path& path, std::size_t row, std::size_t observable) const {
        if (observable == 2) return 1.0;
        if (!room()) return observable == 0 ? 1.0 : 0.0;
        const double seen = observable == 0 ? std::cos(path.middle[row]) : std::sin(path.middle[row]);
        return seen * seen;
    }

    void gather(const Experiment& experiment, const Rows& rows) {
        std::vector<double> y, theta, load, incline;
        const Observable base =
            rows.observable("x_m", NoiseKind::Level,
                            {{y, "y_m"}, {theta, "theta_rad"}, {load, "load_kg"}, {incline, "incline_rad"}});
        const std::vector<double>& x = base.y;
        has_counters_ = experiment.has("steps_left");
        counted_ = has_counters_ && experiment.has("cmd_left");
        exact_ = experiment.nominal_or("firmware.agenda", 1.0) == 0;
        const Motor motor = motor_of(experiment);
        std::array<std::vector<double>, 3> sums;
        double along = 0, across = 0, heading = 0;
        std::size_t from = 0;
        for (std::size_t i = 0; i < base.y.size(); ++i) {
            const bool begins = base.starts[i] != 0;
            if (begins) {
                const Run& run = experiment.runs[base.run[i]];
                Path path;
                path.run = base.run[i];
                for (std::size_t w = 0; w < 2; ++w) {
                    const auto& [counter, command] = kWheelColumns[w];
                    path.wheel[w] = WheelCurve::counted(run, counter, command, motor);
                    if (!counted_) continue;
                    path.asked[w] = WheelCurve::commanded(run, command, motor);
                    path.wheel[w].unround(path.asked[w]);
                }
                paths_.push_back(std::move(path));
                along = across = heading = 0;
                from = i;
            }
            Path& path = paths_.back();
            double turned = 0, middle = theta[i];
            if (!begins) {
                turned = std::remainder(theta[i] - theta[i - 1], 2 * std::numbers::pi);
                middle = theta[i - 1] + turned / 2;
                const double dx = x[i] - x[i - 1], dy = y[i] - y[i - 1];
                along += dx * std::cos(middle) + dy * std::sin(middle);
                across += -dx * std::sin(middle) + dy * std::cos(middle);
                heading += turned;
            }
            const auto& clock = experiment.runs[path.run].counted_at;
            path.time.push_back(clock.empty() ? base.time[i] : clock[base.row[i]]);
            path.middle.push_back(middle);
            path.load.push_back(load[i]);
            path.incline.push_back(incline[i]);
            along_.push_back(along);
            sums[0].push_back(room() ? x[i] - x[from] : along);
            sums[1].push_back(room() ? y[i] - y[from] : across);
            sums[2].push_back(heading);
        }
        const std::array<const char*, 3> names{room() ? "x_m" : "along", room() ? "y_m" : "across",
                                               "heading"};
        for (std::size_t o = 0; o < 3; ++o) {
            observables_.push_back(base);
            Observable& one = observables_.back();
            one.name = names[o];
            one.unit = o == 2 ? "rad" : "m";
            one.instrument = {NAN, NAN, o == 2 ? quantum_of(theta) : base.instrument.quantum};
            one.y = sums[o];
            // A place in the room and a heading are looked up anew in each row; of way along and across,
            // which are summed along measured headings, errors add up.
            one.steady = room() || o == 2;
        }
        if (counted_) gather_counters(experiment);
    }

    /// Without the agenda it is the project's firmware or a robot that keeps to its commands: its counters
    /// show which. (A plan that is off by parts of a step wanders where counters are exact.)
    Motor motor_of(const Experiment& experiment) const {
        // A counter has counted what a start made.
        Motor motor{exact_ ? MotorDriver::Timer : MotorDriver::Agenda,
                    counted_ ? 0.0 : experiment.nominal_or("firmware.start_loss", 0.0)};
        if (!exact_ || !counted_) return motor;
        double from_timer = 0.0, from_exact = 0.0;
        for (const Run& run : experiment.runs)
            for (const auto& [counter, command] : kWheelColumns) {
                const WheelCurve counted = WheelCurve::counted(run, counter, command, motor);
                from_timer += counted.strays_from(WheelCurve::commanded(run, command, motor));
                from_exact += counted.strays_from(WheelCurve::commanded(run, command, {MotorDriver::Exact}));
            }
        if (from_exact < from_timer) motor.driver = MotorDriver::Exact;
        return motor;
    }

    /// By how much a robot turns in each row, by its wheels: the tracker's noise turns nothing.
    std::vector<double> turns() const {
        const MotionNumbers values = nominal();
        const double metre = values.metre();
        std::vector<double> turned;
        for (const Path& path : paths_) {
            CurveReader left(path.wheel[0]), right(path.wheel[1]);
            double last = 0.0;
            for (std::size_t i = 0; i < path.time.size(); ++i) {
                const double apart = right.at(path.time[i]) - left.at(path.time[i]);
                turned.push_back(i == 0 ? 0.0 : (apart - last) * metre / values.robot.axle_length);
                last = apart;
            }
        }
        return turned;
    }

    /// What a change of command leaves open: where in a step it came, and how exactly the tyres slid.
    std::vector<double> jolts(std::size_t observable) const {
        const MotionNumbers values = nominal();
        const double metre = values.metre(), lever = observable == 2 ? 1 / values.robot.axle_length : 0.5;
        std::vector<double> variance;
        for (const Path& path : paths_)
            for (std::size_t i = 0; i < path.time.size(); ++i) {
                double sum = 0.0;
                for (std::size_t w = 0; i > 0 && w < 2; ++w)
                    for (const SpeedJump& jump : path.wheel[w].jumps)
                        if (jump.time >= path.time[i - 1] && jump.time < path.time[i]) {
                            const double slid =
                                std::pow(jump.change * metre, 2) * values.friction / (2 * kGravity);
                            sum += std::pow(kOpenSteps * metre, 2) + std::pow(kOpenSlip * slid, 2);
                        }
                variance.push_back(sum * lever * lever * share_along(path, i, observable));
            }
        return variance;
    }

    void gather_counters(const Experiment& experiment) {
        for (const auto& [counter, command] : kWheelColumns) {
            const Rows rows(experiment, "", {"t_s", counter});
            Observable one = rows.observable(counter, NoiseKind::Level, {});
            one.unit = "steps";
            one.instrument.quantum = 0.0;
            one.fixed_sd = kCounterSd;
            observables_.push_back(std::move(one));
        }
    }

    void declare_all() {
        simulated("robot.", {"wheel_radius_left", "wheel_radius_right", "axle_length", "steps_per_turn"});
        declare({{&MotionNumbers::agenda, "firmware.agenda", "1"},
                 {&MotionNumbers::start_loss, "firmware.start_loss", "1"},
                 {&MotionNumbers::scale, "wheel_scale", "1"},
                 {&MotionNumbers::mismatch, "wheel_mismatch", "1"}});
        simulated("robot.", {"turn_scrub"});
        declare({{&MotionNumbers::friction, "inverse_friction", "1"}});
        simulated("robot.", {"load_creep", "slope_creep", "step_loss_speed", "step_loss_width", "deadband",
                             "backlash"});
        declare({{&MotionNumbers::latency, "command.latency", "s"},
                 {&MotionNumbers::drop, "command.loss", "1"},
                 {&MotionNumbers::burst, "command.loss_burst", "1"}});
        simulated("robot.", {"drift_x", "drift_y"});
        simulated("push.", {"rate", "size", "turn"});
        declare({{&MotionNumbers::marker_x, "tracker.marker_x", "m"},
                 {&MotionNumbers::marker_y, "tracker.marker_y", "m"},
                 {&MotionNumbers::marker_angle, "tracker.marker_angle", "rad"},
                 {&MotionNumbers::delay, "tracker.delay", "s"},
                 {&MotionNumbers::heading_drift, "tracker.heading_drift", "rad/s"},
                 {&MotionNumbers::heading_span, "tracker.heading_span", "ln s"},
                 {&MotionNumbers::heading_doubt, "tracker.heading_doubt", "ln rad"},
                 {&MotionNumbers::late_step, "counter.late_step", "1"}});
        if (counted_) nuisances_.push_back({*find("counter.late_step"), 0.0, kMostLateStep, kLateStep});
        nuisances_.push_back(
            {*find("tracker.heading_doubt"), std::log(kLeastDoubt), std::log(kMostDoubt), kDoubtWidth});
        nuisances_.push_back({*find("tracker.heading_span"), std::log(kShortestSpan), std::log(kLongestSpan),
                              kSpanWidth, true});
    }

    void drive(const MotionNumbers& values, const Path& path, double late, std::size_t first,
               Prediction& out) const {
        const physics::BodyParameters& robot = values.robot;
        const double turn = 2 * std::numbers::pi / robot.steps_per_turn;
        const std::array<double, 2> metre{
            turn * robot.wheel_radius_left * (1 + values.scale) * (1 - values.mismatch),
            turn * robot.wheel_radius_right * (1 + values.scale) * (1 + values.mismatch)};
        const double drop = counted_ ? 0.0 : values.drop;
        std::array<CurveReader, 2> pacer{CurveReader(path.paced(0)), CurveReader(path.paced(1))};
        std::array<CurveReader, 2> pieces{pacer};  // at a knot the last digit depends on where one comes from
        std::array<CurveReader, 2> reader{CurveReader(path.wheel[0]), CurveReader(path.wheel[1])};
        std::array<double, 2> last{}, last_asked{}, driven{}, geared{}, last_geared{};
        double heading = 0;
        std::vector<Step> steps(path.time.size());
        for (std::size_t i = 0; i < path.time.size(); ++i) {
            bool moves = false;
            const double now = path.time[i] - late, before = i == 0 ? now : path.time[i - 1] - late,
                         span = now - before;
            std::array<double, 2> moved{};
            double slips = 0.0;  // variance of the way that is lost, m2
            for (std::size_t w = 0; w < 2; ++w) {
                const double made = reader[w].at(now), asked = pacer[w].at(now);
                moves = moves || (i > 0 && std::abs(asked - last_asked[w]) > kStill);
                double change = i == 0 ? 0.0 : made - last[w];
                last[w] = made;
                last_asked[w] = asked;
                if (change != 0.0 && span > 0) {
                    const double rate = std::abs(change) / span;
                    if (robot.step_loss_speed > 0) {
                        const double lost =
                            change / (1 + std::exp(-(rate - robot.step_loss_speed) / robot.step_loss_width));
                        change -= lost;
                        slips += kSlip * std::abs(lost) * metre[w] * metre[w];
                    }
                    if (robot.deadband > 0)
                        change *= let_through(path.paced(w), pieces[w], robot.deadband, before, now);
                }
                driven[w] += change * metre[w];
                const double play = robot.backlash / 2 * metre[w] / turn;
                geared[w] = std::clamp(geared[w], driven[w] - play, driven[w] + play);
                moved[w] = geared[w] - last_geared[w];
                last_geared[w] = geared[w];
                if (span > 0)
                    moved[w] -=
                        slipped(path.wheel[w].jumps, metre[w], values.friction, 2 * play, before, now);
                moved[w] *= 1 - robot.load_creep * path.load[i] - robot.slope_creep * path.incline[i];
            }
            double way = (moved[0] + moved[1]) / 2;
            const double twist = std::abs(moved[1] - moved[0]) / 2;
            const double wide =
                robot.turn_scrub == 0.0 || twist < 1e-9
                    ? robot.axle_length
                    : robot.axle_length * (1 + robot.turn_scrub * twist / (std::abs(way) + twist));
            const double turned = (moved[1] - moved[0]) / wide;
            const double lever = 2 * std::sin(turned / 2);
            if (std::abs(turned) > 1e-6) way *= lever / turned;
            double aside = 0.0;
            if (moves && (robot.drift_x != 0.0 || robot.drift_y != 0.0)) {
                const double c = std::cos(path.middle[i]), s = std::sin(path.middle[i]);
                way += (robot.drift_x * c + robot.drift_y * s) * span;
                aside += (-robot.drift_x * s + robot.drift_y * c) * span;
            }
            way -= lever * values.marker_y;
            aside += lever * values.marker_x;
            heading += turned + values.heading_drift * span;
            out[2].mean[first + i] = heading;
            steps[i] = {way, aside,
                        values.marker_angle +
                            values.heading_drift * (path.time[i] - path.time.front() - span / 2)};
            if (robot.step_loss_speed > 0) {
                for (std::size_t o = 0; o < 2; ++o)
                    if (!out[o].jolt.empty()) out[o].jolt[first + i] = slips / 4 * share_along(path, i, o);
                out[2].jolt[first + i] = slips / (robot.axle_length * robot.axle_length);
            }
            const bool pushed = values.push.rate > 0 && settled(path, before, span);
            for (std::size_t o = 0; pushed && o < 3; ++o) {
                out[o].lapse[first + i] = std::min(values.push.rate * span, 0.5);
                out[o].lapse_scale[first + i] = o == 2 ? values.push.turn : values.push.size;
            }
            if (drop > 0)
                lapses_of_loss(drop, values.again(), metre, robot.axle_length, path, i, before, now,
                               first + i, out);
        }
        predict_place(std::exp(values.heading_span), path, steps, first, out);
    }

    /// What a robot does between two rows, and the angle by which the tracker's heading is off, noise apart.
    struct Step {
        double way = 0.0, aside = 0.0, skew = 0.0;
    };

    /// Where steps lead to, along the tracker's heading: what turns that turns the way. In the room it
    /// is the robot's own heading that leads, as far as it is known.
    void predict_place(double span, const Path& path, const std::vector<Step>& steps, std::size_t first,
                       Prediction& out) const {
        const std::size_t n = steps.size();
        thread_local std::vector<double> above, kept, errors;
        above.resize(n);
        for (std::size_t i = 0; i < n; ++i)
            above[i] = observables_[2].y[first + i] - out[2].mean[first + i];
        kept.clear();
        const auto rows = [&](const std::vector<double>& all) {
            return all.empty() ? std::span<const double>() : std::span(all).subspan(first, n);
        };
        const Predicted& heading = out[2];
        if (!heading.lapse.empty() || !heading.jolt.empty())
            kept_headings(above, {rows(heading.lapse), rows(heading.lapse_scale), rows(heading.jolt)}, kept);
        heading_errors(above, path.time, span, kept, errors);
        double along = 0, across = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const Step& step = steps[i];
            const double off = step.skew + (i == 0 ? 0.0 : (errors[i - 1] + errors[i]) / 2);
            const double axis = room() ? off - path.middle[i] : off;
            double cosine = 1 - axis * axis / 2, sine = axis * (1 - axis * axis / 6);
            if (std::abs(axis) > kSmallAngle) cosine = std::cos(axis), sine = std::sin(axis);
            along += step.way * cosine + step.aside * sine;
            across += step.aside * cosine - step.way * sine;
            out[0].mean[first + i] = along;
            out[1].mean[first + i] = across;
            out[1].lever[first + i] = -along;
            if (room()) out[0].lever[first + i] = across;
        }
    }

    void lapses_of_loss(double drop, double again, const std::array<double, 2>& metre, double axle,
                        const Path& path, std::size_t i, double before, double now, std::size_t row,
                        Prediction& out) const {
        const std::array<Loss, 2> loss{lost(path.wheel[0].jumps, drop, again, before, now),
                                       lost(path.wheel[1].jumps, drop, again, before, now)};
        const double left = std::abs(loss[0].steps) * metre[0], right = std::abs(loss[1].steps) * metre[1];
        const double chance = std::max(loss[0].chance, loss[1].chance);
        for (std::size_t o = 0; o < 3; ++o) {
            const double scale =
                o == 2 ? (left + right) / axle : (left + right) / 2 * std::sqrt(share_along(path, i, o));
            if (scale <= 1e-9) continue;
            out[o].lapse[row] = chance;
            out[o].lapse_scale[row] = scale;
        }
    }

    /// What counters would have counted of the commands; where a run has no pose, what they did count.
    void predict_counters(const MotionNumbers& now, Prediction& out) const {
        for (std::size_t w = 0; w < 2; ++w) {
            const Observable& o = observables_[3 + w];
            Predicted& p = out[3 + w];
            p.mean = o.y;
            // Whatever else makes a counter jump costs once, and not in all rows after it.
            p.lapse.assign(o.y.size(), kStray);
            p.lapse_scale.assign(o.y.size(), kStraySteps);
            p.lapse_shift.assign(o.y.size(), 0.0);
            auto path = paths_.begin();
            for (std::size_t first = 0, end = 0; first < o.y.size(); first = end) {
                while (end < o.y.size() && o.run[end] == o.run[first])
                    ++end;
                while (path != paths_.end() && path->run < o.run[first])
                    ++path;
                if (path != paths_.end() && path->run == o.run[first])
                    predict_counter(now, path->asked[w], o, first, end, p);
            }
        }
    }

    /// In the rows [first, end) of a run.
    static void predict_counter(const MotionNumbers& now, const WheelCurve& commanded, const Observable& o,
                                std::size_t first, std::size_t end, Predicted& p) {
        const double start = CurveReader(commanded).at(o.time[first]);
        CurveReader reader(commanded);
        double count = 0.0;  // behind what was asked for by the part of a step that is not counted yet
        for (std::size_t i = first; i < end; ++i) {
            const double asked = reader.at(o.time[i] - now.latency) - start;
            count = std::clamp(count, asked - now.late_step, asked + now.late_step);
            p.mean[i] = o.y[first] + count;
            if (now.drop <= 0) continue;
            const double before = i == first ? o.time[i] : o.time[i - 1];
            const Loss loss = lost(commanded.jumps, now.drop, now.again(), before, o.time[i]);
            if (loss.chance < kStray) continue;
            p.lapse[i] = loss.chance;
            p.lapse_shift[i] = loss.steps;
            p.lapse_scale[i] = kLossDoubt * std::abs(loss.steps);
        }
    }

    MotionView view_;
    std::vector<Path> paths_;
    std::vector<double> along_;  // way along the tracker's heading, a row each
    bool has_counters_ = false;
    bool counted_ = false;  ///< counters and commands
    bool exact_ = false;    ///< wheels keep to their commands: no agenda makes a staircase of them
};

}  // namespace

std::unique_ptr<Model> make_motion_model(const Experiment& experiment, MotionView view) {
    return std::make_unique<MotionModel>(experiment, view);
}

}  // namespace puckloop::gap
