#include "selftest/emulate/surroundings.h"

#include "physics/description/parameters.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace puckloop::gap::emulate {

namespace {

constexpr double kQuantum = 1e-4;  // rad, of the spirit level
constexpr double kRidge = 1e-6;    // a run without a turn tells the tilt along its heading only

double taken(const char* name, double value) {
    int index = -1;
    const auto* info = physics::find_parameter(name, index);
    return std::clamp(value, info->min, info->max);
}

}  // namespace

void note_surroundings(const Act& act, const std::vector<Row>& rows, WrittenRun& run) {
    for (const Row& r : rows) {
        const double rise =
            std::sin(act.slope_x) * std::cos(r.theta) + std::sin(act.slope_y) * std::sin(r.theta);
        run.column("load_kg", "kg").values.push_back(act.load);
        run.column("incline_rad", "rad").values.push_back(std::round(std::asin(rise) / kQuantum) * kQuantum);
    }
}

void restore_surroundings(const Run& run, Act& act) {
    const auto& incline = run.column("incline_rad");
    const auto& theta = run.column("theta_rad");
    for (const double kilograms : run.column("load_kg"))
        act.load = std::max(act.load, taken("robot.load", std::isnan(kilograms) ? 0.0 : kilograms));
    if (incline.empty()) return;
    // rise = sx cos + sy sin, by least squares
    double cc = kRidge, cs = 0, ss = kRidge, cr = 0, sr = 0;
    for (std::size_t i = 0; i < run.rows; ++i) {
        if (std::isnan(theta[i]) || std::isnan(incline[i])) continue;
        const double c = std::cos(theta[i]), s = std::sin(theta[i]), rise = std::sin(incline[i]);
        cc += c * c, cs += c * s, ss += s * s, cr += c * rise, sr += s * rise;
    }
    const double d = cc * ss - cs * cs;
    act.slope_x = taken("world.slope_x", std::asin(std::clamp((ss * cr - cs * sr) / d, -1.0, 1.0)));
    act.slope_y = taken("world.slope_y", std::asin(std::clamp((cc * sr - cs * cr) / d, -1.0, 1.0)));
}

}  // namespace puckloop::gap::emulate
