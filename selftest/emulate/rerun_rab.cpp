#include "selftest/emulate/rerun_rab.h"

#include "physics/description/parameters.h"
#include "reproductions/rab/measure.h"
#include "scenarios/reader/read_scenario.h"
#include "selftest/emulate/record_rab.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

namespace puckloop::gap::emulate {

namespace {

constexpr std::size_t kDistances = 12;  // at most so many are performed
constexpr int kRepeats = 8;             // poses of a pair at a distance
constexpr int kPairs = 24, kBriefPairs = 6;
constexpr double kFineDistance = 1e-3;  // m: closer distances are one
constexpr double kFineRate = 0.1;       // Hz
constexpr int kRatePairs = 4, kRateRepeats = 72;
constexpr std::size_t kFirstPoses = 32;  // of a rate, in which a slow host's queue fills: left out

struct Message {
    double distance = 0.0;  // m
    long rate = 0;          // frames a second, in kFineRate; 0: each is waited for
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
            const double rate = cell("arrival_rate", i);
            one.rate = rate > 0 ? std::lround(rate / kFineRate) : 0;
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

/// The distances of most messages at this rate, rising.
std::vector<double> distances_of(const std::vector<Message>& messages, long rate) {
    std::map<long, std::size_t> counts;
    for (const Message& one : messages)
        if (one.distance >= 0 && one.rate == rate) ++counts[std::lround(one.distance / kFineDistance)];
    std::vector<std::pair<std::size_t, long>> most;
    for (const auto& [place, count] : counts)
        most.emplace_back(count, place);
    std::sort(most.rbegin(), most.rend());
    most.resize(std::min(most.size(), kDistances));
    std::vector<double> distances;
    for (const auto& [count, place] : most)
        distances.push_back(static_cast<double>(place) * kFineDistance);
    std::sort(distances.begin(), distances.end());
    return distances;
}

/// What has to be measured again: one measurement for each rate.
std::map<long, tools::RabMeasurement> plans_of(const std::vector<Message>& messages,
                                               const RerunOptions& options) {
    std::map<long, tools::RabMeasurement> plans;
    for (const Message& one : messages)
        plans.try_emplace(one.rate);
    for (auto place = plans.begin(); place != plans.end();) {
        auto& [rate, what] = *place;
        what.firmware = options.tools.rab;
        what.distances = distances_of(messages, rate);
        what.repeats = rate > 0 ? kRateRepeats : kRepeats;
        what.pairs = rate > 0 ? kRatePairs : options.longest > 0 ? kBriefPairs : kPairs;
        if (rate > 0) what.turn = 1 / (static_cast<double>(rate) * kFineRate);
        place = what.distances.empty() ? plans.erase(place) : std::next(place);
    }
    return plans;
}

void perform(const tools::RabMeasurement& what, long rate, std::vector<Message>& messages) {
    const std::size_t of_pair = 2 * what.distances.size() * static_cast<std::size_t>(what.repeats);
    const auto rows = tools::measure_rab(
                          what, [](double) {}, nullptr)
                          .rows;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (rate > 0 && k % of_pair < 2 * kFirstPoses) continue;
        const tools::RabReadingRow& row = rows[k];
        Message one;
        one.distance = what.distances[row.distance];
        one.rate = rate;
        one.receiver = nearest_receiver(row.bearing_true);
        one.received = row.received;
        if (row.received && row.range > 0) one.strength = std::log(row.range);
        if (row.received)
            one.bearing_error = std::remainder(row.bearing - row.bearing_true, 2 * std::numbers::pi);
        messages.push_back(one);
    }
}

double found(const Verdict& verdict, std::string_view parameter) {
    for (const Cause& cause : verdict.causes)
        for (const FittedParameter& one : cause.parameters)
            if (one.name == parameter) return one.value;
    return 0.0;
}

struct Moments {
    double sum = 0.0, squares = 0.0;
    std::size_t rows = 0;
    void add(double value) {
        if (std::isnan(value)) return;
        sum += value;
        squares += value * value;
        ++rows;
    }
    double mean() const { return sum / static_cast<double>(rows); }
};
using Groups = std::map<std::pair<long, int>, Moments>;

/// Of messages: strength by distance and nearest receiver, bearing's error by receiver, share received by
/// rate.
struct Seen {
    Groups strength, bearing, received;
};

Seen seen_in(const std::vector<Message>& messages) {
    Seen seen;
    for (const Message& one : messages) {
        seen.strength[{std::lround(one.distance / kFineDistance), one.receiver}].add(one.strength);
        seen.bearing[{0, one.receiver}].add(one.bearing_error);
        seen.received[{one.rate, 0}].add(one.received ? 1.0 : 0.0);
    }
    return seen;
}

/// Root mean square of the groups' differences, weighted by measured rows; rows 0: nothing to compare.
std::pair<double, std::size_t> difference(const Groups& measured, const Groups& other) {
    double squares = 0.0;
    std::size_t rows = 0;
    for (const auto& [group, own] : measured) {
        const auto place = other.find(group);
        if (own.rows == 0 || place == other.end() || place->second.rows == 0) continue;
        squares += static_cast<double>(own.rows) * std::pow(own.mean() - place->second.mean(), 2);
        rows += own.rows;
    }
    return {std::sqrt(squares / static_cast<double>(std::max<std::size_t>(rows, 1))), rows};
}

/// Standard deviation about the groups' means.
double scatter(const Groups& groups) {
    double squares = 0.0, free = 0.0;
    for (const auto& [group, own] : groups)
        if (own.rows > 1) {
            squares += own.squares - own.sum * own.mean();
            free += static_cast<double>(own.rows - 1);
        }
    return std::sqrt(std::max(squares, 0.0) / std::max(free, 1.0));
}

/// In the order of the sides.
using PerformedMessages = std::vector<Seen>;

template <class Error>
void add_errors(const char* name, const char* unit, const PerformedMessages& performed, const Error& error,
                Rerun& result) {
    std::vector<double> errors;
    for (const Seen& seen : performed)
        errors.push_back(error(seen));
    result.observables.push_back(observable_of(name, unit, errors));
}

void compare(const char* name, const char* unit, Groups Seen::*part, const Seen& told,
             const PerformedMessages& performed, Rerun& result) {
    const std::size_t rows = difference(told.*part, performed[0].*part).second;
    if (rows == 0) return;
    result.rows = std::max(result.rows, rows);
    add_errors(
        name, unit, performed, [&](const Seen& seen) { return difference(told.*part, seen.*part).first; },
        result);
}

void compare_scatter(const char* name, const char* unit, Groups Seen::*part, const Seen& told,
                     const PerformedMessages& performed, Rerun& result) {
    if ((told.*part).empty() || (performed[0].*part).empty()) return;
    const double own = scatter(told.*part);
    add_errors(
        name, unit, performed, [&](const Seen& seen) { return std::abs(own - scatter(seen.*part)); }, result);
}

}  // namespace

Rerun rerun_rab(const Experiment& experiment, const Verdict& verdict, const RerunOptions& options) {
    Rerun result;
    result.asked = true;
    const auto messages = measured(experiment);
    const auto plans = plans_of(messages, options);
    if (plans.empty()) {
        result.not_done = "no row with a distance";
        return result;
    }
    const Seen told = seen_in(messages);
    PerformedMessages performed;
    const auto seeds = seeds_of(options);
    for (std::size_t side = 0; side < seeds.size(); ++side) {
        scenarios::Scenario scenario;
        scenario.world.arena = physics::rectangular_arena(4, 4);
        for (const auto& [name, value] : experiment.nominal) {
            int index = -1;
            if (physics::find_parameter(name, index) != nullptr) scenario.world.parameters[name] = value;
        }
        if (side == kOverlaySide) scenarios::apply_overlay(scenario, options.overlay);
        const bool is_true = side >= kTrueSide;
        std::vector<Message> of_side;
        for (const auto& [rate, plan] : plans) {
            tools::RabMeasurement what = plan;
            what.seed = seeds[side] + static_cast<std::uint64_t>(rate);
            what.parameters = is_true ? options.truth->parameters : scenario.world.parameters;
            if (rate > 0 && is_true) what.poll_period = options.truth->rab_poll;
            if (rate > 0 && side == kOverlaySide) what.poll_period = found(verdict, kFetchTime);
            perform(what, rate, of_side);
        }
        performed.push_back(seen_in(of_side));
        if (options.done) options.done(side + 1, seeds.size());
    }
    compare("strength", "ln counts", &Seen::strength, told, performed, result);
    compare_scatter("strength scatter", "ln counts", &Seen::strength, told, performed, result);
    compare("bearing", "rad", &Seen::bearing, told, performed, result);
    compare_scatter("bearing scatter", "rad", &Seen::bearing, told, performed, result);
    compare("received", "1", &Seen::received, told, performed, result);
    for (const auto& [rate, plan] : plans)
        result.runs += static_cast<std::size_t>(plan.pairs);
    result.of_runs = result.runs;
    return result;
}

}  // namespace puckloop::gap::emulate
