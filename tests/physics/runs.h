#pragma once
// Channels of a robot over a run, and their statistics, for the tests of what changes from step to step.

#include "tests/physics/worlds.h"

#include <numeric>
#include <vector>

namespace puckloop::physics::test {

struct Drive {
    double left = 0.0, right = 0.0, seconds = 1.0;  // steps/s, steps/s, s
};

/// All channels after each step.
inline std::vector<Channels> run(const World& world, const Drive& drive) {
    WorldModel model(world);
    Driver driver(model);
    std::vector<Channels> all;
    const auto steps = std::lround(drive.seconds / kStepSeconds);
    for (long k = 0; k < steps; ++k) {
        driver.feed(drive.left, drive.right);
        model.step();
        all.push_back(model.robot(0).channels());
    }
    return all;
}

inline World with(World world, const std::map<std::string, double>& parameters) {
    for (const auto& [name, value] : parameters)
        world.parameters[name] = value;
    return world;
}

/// One channel's values less those of another run, from step `from` on.
inline std::vector<double> difference(const std::vector<Channels>& a, const std::vector<Channels>& b,
                                      std::size_t channel, std::size_t from = 0) {
    std::vector<double> all;
    for (std::size_t k = from; k < a.size(); ++k)
        all.push_back(a[k][channel] - b[k][channel]);
    return all;
}

inline double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

inline double sd_of(const std::vector<double>& values) {
    const double mean = mean_of(values);
    double sum = 0.0;
    for (const double value : values)
        sum += (value - mean) * (value - mean);
    return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Share of values further than `limit` from 0.
inline double share_beyond(const std::vector<double>& values, double limit) {
    double count = 0.0;
    for (const double value : values)
        count += std::abs(value) > limit ? 1 : 0;
    return count / static_cast<double>(values.size());
}

/// Correlation of each value with the one before.
inline double carry_of(const std::vector<double>& values) {
    const double mean = mean_of(values);
    double sum = 0.0;
    for (std::size_t k = 1; k < values.size(); ++k)
        sum += (values[k] - mean) * (values[k - 1] - mean);
    return sum / static_cast<double>(values.size()) / std::pow(sd_of(values), 2);
}

}  // namespace puckloop::physics::test
