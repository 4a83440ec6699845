#include "selftest/grammar/site.h"

#include "physics/description/robot_constants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace puckloop::gap::selftest::grammar {

namespace {

using How = Site::How;

constexpr double kAxle = physics::kAxleLength;
constexpr double kSmallTurn = 0.01;   // rad a row, at field 1
constexpr double kSmallSlide = 1e-3;  // m a row, at field 1
constexpr double kStill = 1e-9;

bool of_a_drive(How how) {
    return how == How::LeftWheel || how == How::RightWheel || how == How::BothWheels || how == How::Heading ||
           how == How::Aside;
}

/// One run's poses from the changed increments.
void drive_again(WrittenRun& run, const Site& site, const std::vector<double>& field, double a) {
    auto &x = run.column("x_m").values, &y = run.column("y_m").values, &h = run.column("theta_rad").values;
    const auto x0 = x, y0 = y, h0 = h;
    for (std::size_t k = 1; k < x.size(); ++k) {
        const double dx = x0[k] - x0[k - 1], dy = y0[k] - y0[k - 1], c = std::cos(h0[k - 1]),
                     s = std::sin(h0[k - 1]);
        double ahead = c * dx + s * dy, aside = -s * dx + c * dy, turn = h0[k] - h0[k - 1];
        const double e = a * field[k], old = turn;
        if (std::abs(ahead) > kStill || std::abs(turn) > kStill) {
            double left = ahead - turn * kAxle / 2, right = ahead + turn * kAxle / 2;
            const double before = (left + right) / 2;
            if (site.how == How::LeftWheel || site.how == How::BothWheels) left *= 1 + e;
            if (site.how == How::RightWheel || site.how == How::BothWheels) right *= 1 + e;
            ahead += (left + right) / 2 - before;
            turn = (right - left) / kAxle;
            if (site.how == How::Heading) turn += kSmallTurn * e;
            if (site.how == How::Aside) aside += kSmallSlide * e;
        }
        const double way = h[k - 1] + (turn - old) / 2;
        x[k] = x[k - 1] + std::cos(way) * ahead - std::sin(way) * aside;
        y[k] = y[k - 1] + std::sin(way) * ahead + std::cos(way) * aside;
        h[k] = h[k - 1] + turn;
    }
}

void lose(WrittenRun& run, const Site& site, const std::vector<double>& field, double a,
          RandomStream& chance) {
    auto& happened = run.column(site.column).values;
    for (std::size_t k = 0; k < happened.size(); ++k)
        if (chance.uniform() < std::min(0.9, a * std::abs(field[k]))) happened[k] = 0.0;
}

}  // namespace

std::string Site::text() const {
    switch (how) {
    case How::Times:
        return column + " times 1 + a ";
    case How::Plus:
        return column + " plus a ";
    case How::Lost:
        return column + " fails with a ";
    case How::LeftWheel:
        return "left wheel times 1 + a ";
    case How::RightWheel:
        return "right wheel times 1 + a ";
    case How::BothWheels:
        return "both wheels times 1 + a ";
    case How::Heading:
        return "turns while driving by a ";
    default:
        return "slides aside by a ";
    }
}

std::vector<Site> sites_of(const std::string& kind) {
    constexpr double kDegree = 0.0175;
    if (kind == "motion")
        return {{How::LeftWheel, "", 1},  {How::RightWheel, "", 1},
                {How::BothWheels, "", 1}, {How::Heading, "", 1},
                {How::Aside, "", 1},      {How::Plus, "x_m", 1e-3},
                {How::Plus, "y_m", 1e-3}, {How::Plus, "theta_rad", 0.5 * kDegree}};
    if (kind == "proximity") return {{How::Times, "reading", 1}, {How::Plus, "reading", 10}};
    if (kind == "ground") return {{How::Times, "reading", 1}, {How::Plus, "reading", 5}};
    if (kind == "microphone") return {{How::Times, "level", 1}, {How::Plus, "level", 10}};
    if (kind == "accelerometer") return {{How::Plus, "ax", 10}, {How::Plus, "ay", 10}, {How::Plus, "az", 10}};
    if (kind == "rab")
        return {{How::Times, "light", 1}, {How::Plus, "bearing_rad", 0.07}, {How::Lost, "received", 1}};
    return {{How::Plus, "t_host_s", 1e-3}, {How::Lost, "frame_ok", 1}};
}

WrittenExperiment with_effect(const WrittenExperiment& exact, const Site& site, const Field& field, double a,
                              RandomStream chance) {
    WrittenExperiment changed = exact;
    for (std::size_t r = 0; r < changed.runs.size(); ++r) {
        WrittenRun& run = changed.runs[r];
        const auto& f = field.value[r];
        if (of_a_drive(site.how)) {
            drive_again(run, site, f, a);
            continue;
        }
        if (site.how == How::Lost) {
            lose(run, site, f, a, chance);
            continue;
        }
        const auto change = [&](std::vector<double>& values) {
            for (std::size_t k = 0; k < values.size(); ++k)
                values[k] = site.how == How::Times ? values[k] * std::max(0.0, 1 + a * f[k])
                                                   : values[k] + a * site.unit * f[k];
        };
        change(run.column(site.column).values);
        // Strength is measured anew from the light; strengths are judged by it.
        if (site.column == "light") change(run.column("strength").values);
    }
    return changed;
}

}  // namespace puckloop::gap::selftest::grammar
