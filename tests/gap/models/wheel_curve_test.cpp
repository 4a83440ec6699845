// What a wheel's motor did, from commands: the two drivers' speeds, and what a start makes too few.

#include "gap/models/motion_path.h"
#include "gap/models/wheel_curve.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

using namespace puckloop::gap;

namespace {

constexpr double kRow = 0.1;  // s

WheelCurve commanded(const std::vector<double>& speeds, double start_loss,
                     MotorDriver driver = MotorDriver::Timer) {
    Run run;
    run.rows = speeds.size();
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        run.columns["t_s"].push_back(kRow * static_cast<double>(i));
        run.columns["cmd_left"].push_back(speeds[i]);
    }
    return WheelCurve::commanded(run, "cmd_left", {driver, start_loss});
}

double at(const WheelCurve& curve, double time) {
    return CurveReader(curve).at(time);
}

}  // namespace

TEST_CASE("each driver makes its own speed of a command") {
    CHECK(at(commanded({0, 600, 0, 0}, 0, MotorDriver::Agenda), 0.3) == Approx(62.5));
    CHECK(at(commanded({0, 600, 0, 0}, 0), 0.3) == Approx(60));
}

TEST_CASE("a counter shows whether the robot keeps to its commands or has the timer's speeds") {
    const std::vector<double> speeds(40, 500.0);  // the timer makes 500.9 of it
    const auto counted = [&](MotorDriver robot) {
        WheelCurve counter = commanded(speeds, 0, robot);
        for (double& steps : counter.steps)
            steps = std::round(steps);
        return counter;
    };
    const WheelCurve exact = commanded(speeds, 0, MotorDriver::Exact), timer = commanded(speeds, 0);
    CHECK(at(exact, 3.0) == Approx(1500));
    CHECK(counted(MotorDriver::Exact).strays_from(exact) < counted(MotorDriver::Exact).strays_from(timer));
    CHECK(counted(MotorDriver::Timer).strays_from(timer) < counted(MotorDriver::Timer).strays_from(exact));
    // Whole steps of a robot that keeps to its commands are the plan's own.
    WheelCurve put_back = counted(MotorDriver::Exact);
    put_back.unround(exact);
    CHECK(at(put_back, 3.0) == Approx(1500));
}

TEST_CASE("a start makes some steps too few, forwards and backwards, and nothing makes up for them") {
    const auto loss = [](const std::vector<double>& speeds) {
        const double last = kRow * static_cast<double>(speeds.size() - 1);
        return at(commanded(speeds, 0), last) - at(commanded(speeds, 1.1), last);
    };
    CHECK(loss({0, 300, 300, 0, 0}) == Approx(1.1));
    CHECK(loss({0, -300, -300, 0, 0}) == Approx(-1.1));
    CHECK(loss({0, 300, 0, 300, 0, 0}) == Approx(2.2));
    // Another speed is no start, nor is a record that begins in the middle of a drive.
    CHECK(loss({0, 300, 450, 450, 0, 0}) == Approx(1.1));
    // The other way round the rotor first makes the step that it is behind, then waits for the first one
    // back.
    CHECK(loss({0, 450, -450, -450, 0, 0}) == Approx(0).margin(1e-9));
    CHECK(loss({0, 450, -450, 450, 450, 0, 0}) == Approx(1.1));
    CHECK(loss({300, 300, 300, 0, 0}) == Approx(0.0).margin(1e-12));
    // Slow steps take several rows to be lost; what is not lost before the stop is not lost later.
    CHECK(loss({0, 5, 5, 5, 5, 0, 0}) == Approx(1.1));
    CHECK(loss({0, 5, 0, 0}) == Approx(0.5));
    CHECK(loss({0, 5, 0, 600, 0, 0}) == Approx(1.6));
}

TEST_CASE("steps are lost by waiting: the motor then runs at full speed") {
    const WheelCurve curve = commanded({0, 50, 50, 0, 0}, 1.0);
    CHECK(at(curve, 0.119) == Approx(0.0).margin(1e-9));
    CHECK(at(curve, 0.2) == Approx(4.0));
    CHECK(at(curve, 0.3) == Approx(9.0));
    Path path;
    path.wheel[0] = curve;
    for (int i = 0; i < 5; ++i)
        path.time.push_back(kRow * i);
    // A dead band below that speed lets all of it through.
    CurveReader pacer(path.paced(0));
    for (std::size_t row = 2; row < 4; ++row)
        CHECK(let_through(path.paced(0), pacer, 45.0, path.time[row - 1], path.time[row]) ==
              Approx(1.0).margin(1e-6));
}
