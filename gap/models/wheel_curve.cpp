#include "gap/models/wheel_curve.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kTicksPerSecond = 1e4;
constexpr double kFineClock = 230400,
                 kCoarseClock = 57600;        // Hz, the own firmware's timers (firmware/epuck/motors.c)
constexpr double kSlow = 4, kFastest = 1000;  // steps/s
constexpr double kRounded = 1.1;              // steps that a counter may be behind for being whole
constexpr double kSmallJump = 20.0;           // steps/s: below, a change of counted speed is rounding

/// Speeds counted between rows, with the parts of one change that fell into two rows put together.
std::vector<SpeedJump> counted_jumps(const WheelCurve& curve) {
    std::vector<SpeedJump> jumps;
    double before = 0.0;
    for (std::size_t i = 1; i < curve.time.size(); ++i) {
        const double span = curve.time[i] - curve.time[i - 1];
        if (span <= 0) continue;
        const double speed = (curve.steps[i] - curve.steps[i - 1]) / span;
        const double change = speed - before;
        before = speed;
        if (std::abs(change) < kSmallJump) continue;
        const bool goes_on = !jumps.empty() && curve.time[i] - jumps.back().time < 2.5 * span &&
                             change * jumps.back().change > 0;
        if (goes_on)
            jumps.back().change += change;
        else
            jumps.push_back({curve.time[i - 1], change, speed - change});
    }
    return jumps;
}

double timer_speed(double command) {
    const double speed = std::min(std::abs(command), kFastest);
    if (speed < 1.0) return 0.0;
    const double clock = speed < kSlow ? kCoarseClock : kFineClock;
    return std::copysign(clock / std::floor((clock + std::floor(speed / 2)) / speed), command);
}

double speed_of(double command, MotorDriver driver) {
    if (driver == MotorDriver::Exact) return command;
    return driver == MotorDriver::Agenda ? agenda_speed(command) : timer_speed(command);
}

}  // namespace

double agenda_speed(double command) {
    const double speed = std::abs(command);
    if (speed < 1e-9) return 0.0;
    const double ticks = std::floor(kTicksPerSecond / speed);
    return std::copysign(kTicksPerSecond / std::max(ticks, 1.0), command);
}

WheelCurve WheelCurve::commanded(const Run& run, std::string_view command, const Motor& motor) {
    WheelCurve curve;
    const auto &time = run.column("t_s"), &asked = run.column(command);
    double sum = 0.0, speed = 0.0, last = 0.0;
    double wait = 0.0;  // steps that are still to be lost of a start
    for (std::size_t i = 0; i < asked.size(); ++i) {
        if (std::isnan(time[i])) continue;
        const bool begins = curve.empty();
        if (!begins) {
            const double lost = std::min(wait, std::abs(speed) * (time[i] - last));
            if (lost > 0) {
                curve.time.push_back(last + lost / std::abs(speed));
                curve.steps.push_back(sum);
                wait -= lost;
            }
            sum += speed * (time[i] - last);
            if (lost > 0) sum -= std::copysign(lost, speed);
        }
        last = time[i];
        curve.time.push_back(time[i]);
        curve.steps.push_back(sum);
        if (std::isnan(asked[i])) continue;
        const double next = speed_of(asked[i], motor.driver);
        if (next != speed) curve.jumps.push_back({time[i], next - speed, speed});
        if (next == 0.0)
            wait = 0.0;
        else if (speed * next <= 0.0 && !begins)  // before the first row it may have run already
            wait = motor.start_loss;
        speed = next;
    }
    if (curve.empty()) return curve;
    curve.time.push_back(last + 1.0);
    curve.steps.push_back(sum + speed);
    return curve;
}

WheelCurve WheelCurve::counted(const Run& run, std::string_view counter, std::string_view command,
                               const Motor& motor) {
    WheelCurve curve;
    const auto &time = run.column("t_s"), &steps = run.column(counter);
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (std::isnan(time[i]) || std::isnan(steps[i])) continue;
        curve.time.push_back(time[i]);
        curve.steps.push_back(steps[i]);
    }
    if (curve.empty()) return commanded(run, command, motor);
    curve.jumps = run.has(command) ? commanded(run, command, motor).jumps : counted_jumps(curve);
    return curve;
}

void WheelCurve::unround(const WheelCurve& asked) {
    if (empty() || asked.empty()) return;
    CurveReader plan(asked);
    double offset = steps.front() - plan.at(time.front());
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const double planned = plan.at(time[i]);
        if (std::abs(planned + offset - steps[i]) > kRounded) offset = steps[i] - planned;
        steps[i] = planned + offset;
    }
}

double WheelCurve::strays_from(const WheelCurve& asked) const {
    if (empty() || asked.empty()) return 0.0;
    CurveReader plan(asked);
    const double offset = steps.front() - plan.at(time.front());
    double sum = 0.0;
    for (std::size_t i = 0; i < steps.size(); ++i)
        sum += std::abs(steps[i] - offset - plan.at(time[i]));
    return sum;
}

double CurveReader::at(double time) {
    const auto &times = curve_.time, &steps = curve_.steps;
    if (times.size() < 2) return times.empty() ? 0.0 : steps[0];
    if (time <= times.front()) return steps.front();  // it stood before the record began
    while (place_ + 1 < times.size() && times[place_] < time)
        ++place_;
    while (place_ > 1 && times[place_ - 1] > time)
        --place_;
    const double span = times[place_] - times[place_ - 1];
    if (span <= 0) return steps[place_];
    return steps[place_ - 1] + (steps[place_] - steps[place_ - 1]) * (time - times[place_ - 1]) / span;
}

}  // namespace puckloop::gap
