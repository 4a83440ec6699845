#include "gap/emulate/rerun_rab.h"

#include "gap/emulate/record_rab.h"
#include "physics/parameters.h"
#include "scenarios/scenario.h"
#include "tools/rab/measure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace puckloop::gap::emulate {

namespace {

constexpr std::size_t kDistances = 12;  // at most so many are performed
constexpr int kRepeats = 12;            // poses of a pair at a distance
constexpr int kPairs = 8, kBriefPairs = 3;
constexpr double kFine = 1e-3;  // m: closer distances are one

struct Message {
    double distance = 0.0;  // m
    int receiver = 1;       // nearest to the sender's direction
    bool received = false;
    double strength = NAN, bearing_error = NAN;  // ln counts; rad
};

std::vector<Message> measured(const Experiment& experiment) {
    std::vector<Message> messages;
    for (const Run& run : experiment.runs) {
        const auto cell = [&](const char* name, std::size_t row) {
            const auto& column = run.column(name);
            return column.empty() ? NAN : column[row];
        };
        for (std::size_t i = 0; i < run.rows; ++i) {
            Message one;
            one.distance = cell("distance_m", i);
            if (std::isnan(one.distance) || cell("emitter", i) > 0) continue;
            const double strength = cell("strength", i), truth = cell("true_bearing_rad", i),
                         received = cell("received", i), nearest = cell("receiver", i);
            one.received = std::isnan(received) ? !std::isnan(strength) : received > 0.5;
            if (strength > 0) one.strength = std::log(strength);
            one.bearing_error = std::remainder(cell("bearing_rad", i) - truth, 2 * std::numbers::pi);
            one.receiver = !std::isnan(nearest) ? static_cast<int>(nearest)
                           : std::isnan(truth)  ? 0
                                                : nearest_receiver(truth);
            messages.push_back(one);
        }
    }
    return messages;
}

/// The distances of most messages, rising.
std::vector<double> distances_of(const std::vector<Message>& messages) {
    std::map<long, std::size_t> counts;
    for (const Message& one : messages)
        if (one.distance >= 0) ++counts[std::lround(one.distance / kFine)];
    std::vector<std::pair<std::size_t, long>> most;
    for (const auto& [place, count] : counts)
        most.emplace_back(count, place);
    std::sort(most.rbegin(), most.rend());
    most.resize(std::min(most.size(), kDistances));
    std::vector<double> distances;
    for (const auto& [count, place] : most)
        distances.push_back(static_cast<double>(place) * kFine);
    std::sort(distances.begin(), distances.end());
    return distances;
}

std::vector<Message> emulated(const tools::RabMeasurement& what) {
    std::vector<Message> messages;
    for (const tools::RabReadingRow& row : tools::measure_rab(
                                               what, [](double) {}, nullptr)
                                               .rows) {
        Message one;
        one.distance = what.distances[row.distance];
        one.receiver = nearest_receiver(row.bearing_true);
        one.received = row.received;
        if (row.received && row.range > 0) one.strength = std::log(row.range);
        if (row.received)
            one.bearing_error = std::remainder(row.bearing - row.bearing_true, 2 * std::numbers::pi);
        messages.push_back(one);
    }
    return messages;
}

struct Mean {
    double sum = 0.0;
    std::size_t rows = 0;
    void add(double value) {
        if (std::isnan(value)) return;
        sum += value;
        ++rows;
    }
    double value() const { return sum / static_cast<double>(rows); }
};
using Groups = std::map<std::pair<long, int>, Mean>;

/// Three tables of means: strength, bearing's error, share received.
std::vector<Groups> groups_of(const std::vector<Message>& messages) {
    std::vector<Groups> groups(3);
    for (const Message& one : messages) {
        const long place = std::lround(one.distance / kFine);
        groups[0][{place, one.receiver}].add(one.strength);
        groups[1][{0, one.receiver}].add(one.bearing_error);
        groups[2][{place, 0}].add(one.received ? 1.0 : 0.0);
    }
    return groups;
}

/// Root mean square of the groups' differences, weighted by measured rows; rows 0: nothing to compare.
std::pair<double, std::size_t> difference(const Groups& measured, const Groups& other) {
    double squares = 0.0;
    std::size_t rows = 0;
    for (const auto& [group, mean] : measured) {
        const auto place = other.find(group);
        if (mean.rows == 0 || place == other.end() || place->second.rows == 0) continue;
        squares += static_cast<double>(mean.rows) * std::pow(mean.value() - place->second.value(), 2);
        rows += mean.rows;
    }
    return {std::sqrt(squares / static_cast<double>(std::max<std::size_t>(rows, 1))), rows};
}

}  // namespace

Rerun rerun_rab(const Experiment& experiment, const RerunOptions& options) {
    Rerun result;
    result.asked = true;
    const auto messages = measured(experiment);
    tools::RabMeasurement what;
    what.firmware = options.tools.rab;
    what.distances = distances_of(messages);
    what.repeats = kRepeats;
    what.pairs = options.longest > 0 ? kBriefPairs : kPairs;
    what.seed = options.seed;
    if (what.distances.empty()) {
        result.not_done = "no row with a distance";
        return result;
    }
    const auto told = groups_of(messages);
    std::vector<Groups> performed[2];
    for (const int side : {0, 1}) {
        scenarios::Scenario scenario;
        scenario.world.arena = physics::rectangular_arena(4, 4);
        for (const auto& [name, value] : experiment.nominal) {
            int index = -1;
            if (physics::find_parameter(name, index) != nullptr) scenario.world.parameters[name] = value;
        }
        if (side == 1) scenarios::apply_overlay(scenario, options.overlay);
        what.parameters = scenario.world.parameters;
        performed[side] = groups_of(emulated(what));
        if (options.done) options.done(static_cast<std::size_t>(side) + 1, 2);
    }
    constexpr const char* kNames[][2] = {{"strength", "ln counts"}, {"bearing", "rad"}, {"received", "1"}};
    for (std::size_t o = 0; o < told.size(); ++o) {
        const auto [before, rows] = difference(told[o], performed[0][o]);
        const double after = difference(told[o], performed[1][o]).first;
        if (rows == 0) continue;
        result.observables.push_back({kNames[o][0], kNames[o][1], before, after});
        result.rows = std::max(result.rows, rows);
    }
    result.runs = result.of_runs = static_cast<std::size_t>(what.pairs);
    return result;
}

}  // namespace puckloop::gap::emulate
