// Infra-red proximity: a reading of one sensor before a flat surface. The response is
// physics::proximity_response, the order of gain, crosstalk, warm-up and offset that of
// physics::ProximityRing.
//
// Deviations: 1. the wall is flat and as wide as the bundle of rays. 2. Crosstalk uses the partners' measured
// readings less their idle ones, with the gains and the noise that are in them. 3. Emitter rise, sampling
// pairs and calibration are the firmware's and the board's; the reading is taken as they leave it.

#include "physics/sensors/proximity.h"
#include "gap/models/foreign_pulses.h"
#include "gap/models/keyed_cache.h"
#include "gap/models/model_of.h"
#include "gap/models/rows.h"
#include "gap/models/spectrum.h"
#include "gap/stats/robust.h"
#include "physics/description/robot_constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

namespace puckloop::gap {

namespace {

constexpr std::size_t kMostObjects = 8;   // stated reflectivities that count as objects
constexpr double kHitSpread = 0.3;        // of a foreign pulse's counts, share
constexpr double kGrazing = 0.02;         // cosine below which a wall is not met
constexpr int kPhases = 8;                // of the schedule against the log's clock that are tried
constexpr double kClearlyStronger = 1.2;  // a line's power, to believe a phase

/// Beside the simulator's: how the laboratory's order acts.
struct ProximityNumbers : physics::Parameters {
    double order_drift = 0.0, order_zero = 0.0;
};

class ProximityModel final : public ModelOf<ProximityNumbers> {
  public:
    explicit ProximityModel(const Experiment& experiment) {
        const Rows rows(experiment, "sensor", {"distance_m", "reading"});
        std::vector<double> sensor, object;
        // clang-format off
        observables_.push_back(rows.observable("reading", NoiseKind::Carry,
            {{distance_, "distance_m"}, {angle_, "angle_rad"}, {reflectivity_, "reflectivity", 1},
             {ambient_, "ambient"}, {pair_, "pair_reading"}, {neighbour_, "neighbour_reading"},
             {motor_, "motor_speed"}, {velocity_, "velocity"}, {time_, "t_s"},
             {others_, "neighbours", experiment.has("neighbours") ? 0.0 : 1.0},
             {battery_, "battery_v", NAN}, {order_, "order", NAN}, {sensor, "sensor"}, {object, "object", 1}}));
        // clang-format on
        center(battery_);
        center(order_);
        if (!order_.empty()) {
            const auto [first, last] = std::ranges::minmax_element(order_);
            half_order_ = (*last - *first) / 2;
            const auto& run = observables_[0].run;
            for (std::size_t i = 1; i < run.size(); ++i)
                if (run[i] == run[i - 1] && order_[i] != order_[i - 1]) half_order_ = 0.0;
        }
        sensor_ = whole(sensor);
        for (std::size_t i = 0; i < sensor_.size(); ++i)
            rows_of_[static_cast<std::size_t>(sensor_[i])].push_back(i);
        const physics::ProximityParameters drawn = physics::Parameters().proximity;
        const auto rays = std::lround(drawn.rays);
        for (long k = 0; k < rays; ++k)
            spread_.push_back(
                drawn.aperture *
                (rays == 1 ? 0.0 : static_cast<double>(k) / static_cast<double>(rays - 1) - 0.5));
        for (const double angle : angle_) {
            cosine_.push_back(std::cos(angle));
            for (const double aside : spread_) {
                ray_cosine_.push_back(std::cos(angle + aside));
                ray_sine_.push_back(std::sin(angle + aside));
            }
        }
        for (auto& speed : motor_)
            speed = std::abs(speed) / physics::kSpeedUnit;
        pulses_ = foreign_pulses(observables_[0], sensor_, distance_, angle_);
        for (std::size_t i = 0; i < others_.size(); ++i)
            if (pulses_.sheltered[static_cast<std::size_t>(sensor_[i])]) others_[i] = 0.0;
        declare_all(objects_of(experiment, object), experiment.nominal_or("proximity.curve", 0.0) == 0);
        apply_nominal(experiment);
        angle0_ = nominal().proximity.direction;
        if (experiment.has("ambient")) {
            observables_[0].gate = ambient_;
            find_schedule();
        }
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        out.resize(1);
        Predicted& p = out[0];
        const std::size_t n = distance_.size();
        p.mean.resize(n);
        const ProximityNumbers all = numbers(v);
        const physics::ProximityParameters& now = all.proximity;
        // The curve changes with few parameters: the rest reuse it. One sensor's direction moves
        // only that sensor's rows.
        // clang-format off
        std::vector<double> key{now.curve, now.amplitude, now.origin, now.exponent, now.saturation, now.reach,
                                now.compression, now.extra_exponent, now.distance_shift, now.incidence_exponent,
                                now.age, 0.0};
        // clang-format on
        for (std::size_t s = 0; s < rows_of_.size(); ++s) {
            if (rows_of_[s].empty()) continue;
            const double turned = now.direction[s] - angle0_[s];
            key.back() = turned;
            const auto seen = seen_[s].get(key, [&] { return see(now, s, turned); });
            for (std::size_t k = 0; k < seen->size(); ++k)
                p.mean[rows_of_[s][k]] = (*seen)[k];
        }
        // Idle reading of a sensor, as far as it is known from the data or the simulator.
        const auto idle = [&](std::size_t sensor) { return now.offset[sensor % physics::kProximitySensors]; };
        for (std::size_t i = 0; i < n; ++i) {
            const auto s = static_cast<std::size_t>(sensor_[i]);
            double seen = p.mean[i];
            if (!object_.empty()) seen *= v[object_[i]];
            // What the others read has its share of this one's light in it, which does not come back again.
            const double own = seen, pair = now.pair_crosstalk, beside = now.neighbour_crosstalk;
            if (pair != 0.0) seen += pair * (pair_[i] - idle(s + kOpposite) - pair * own);
            if (beside != 0.0)
                seen += beside * (neighbour_[i] - idle(s + 1) - idle(s + physics::kProximitySensors - 1) -
                                  2 * beside * own);
            double gain = now.scale * now.gain[s] * (1 - now.ambient_gain * ambient_[i]);
            gain *= 1 + warmed(now.warmup_gain, time_[i], now.warmup_time);
            if (!battery_.empty()) gain *= 1 + now.battery_gain * battery_[i];
            if (!order_.empty()) gain *= 1 + all.order_drift * (order_[i] - all.order_zero * half_order_);
            p.mean[i] = (gain * seen + now.offset[s] + now.ambient_offset * ambient_[i]) *
                        (1 - now.motor_sag * (motor_[i] > 0 ? 1.0 : 0.0));
        }
        p.floor = now.threshold;
        noise(now, p);
    }

    std::vector<double> starts(std::string_view parameter) const override {
        if (parameter == "proximity.threshold") return thresholds();
        if (parameter == "proximity.age") return ages();
        if (parameter == "proximity.interference_size" && pulses_.size > 0) return {pulses_.size};
        if (parameter == "proximity.flicker_frequency" && line_frequency_found_ > 0)
            return {line_frequency_found_};
        return {};
    }

    /// Sensors that no foreign pulse hits.
    std::map<std::string, double> implied() const override {
        std::map<std::string, double> shares;
        for (std::size_t s = 0; s < pulses_.sheltered.size(); ++s)
            if (pulses_.sheltered[s]) shares[fmt::format("proximity.interference_share{}", s)] = 0.0;
        return shares;
    }

  private:
    /// The age that readings of moving surfaces are nearest to. Heavy-tailed noise takes few such rows for
    /// outliers: a fit that begins at none stays at an age that only the far ones bear.
    std::vector<double> ages() const {
        constexpr double kYoungest = 5e-4, kOldest = 0.5, kRatio = 1.15;  // s
        if (std::ranges::all_of(velocity_, [](double v) { return v == 0.0; })) return {};
        std::vector<double> values = neutral();
        Prediction prediction;
        double best = 0.0, least = INFINITY;
        const auto look_at = [&](double age) {
            values[*find("proximity.age")] = age;
            predict(values, prediction);
            double sum = 0.0;
            for (std::size_t i = 0; i < velocity_.size(); ++i)
                if (velocity_[i] != 0.0) sum += std::abs(observables_[0].y[i] - prediction[0].mean[i]);
            if (sum >= least) return;
            least = sum;
            best = age;
        };
        look_at(0.0);
        for (double age = kYoungest; age < kOldest; age *= kRatio)
            look_at(age);
        return {best};
    }

    /// The dead zone that parts the readings of nothing from the others best; none where nothing reads 0.
    std::vector<double> thresholds() const {
        constexpr double kLowest = 3.0, kHighest = 2000.0, kRatio = 1.02;
        const auto& y = observables_[0].y;
        if (std::ranges::none_of(y, [](double reading) { return reading <= 0; })) return {};
        const Prediction prediction = predicted(neutral());
        double best = 0.0;
        std::size_t fewest = y.size() + 1;
        for (double threshold = kLowest; threshold < kHighest; threshold *= kRatio) {
            std::size_t wrong = 0;
            for (std::size_t i = 0; i < y.size(); ++i)
                wrong += y[i] <= 0 ? prediction[0].mean[i] > threshold : y[i] < threshold;
            if (wrong > fewest) continue;
            fewest = wrong;
            best = threshold;
        }
        return {best};
    }

    /// Readings are held between two samples of the sensor's schedule, whose phase is not in the log: the
    /// one that gives the strongest line is taken, where it is clearly stronger than without a schedule.
    void find_schedule() {
        const Prediction prediction = predicted(neutral());
        Observable& o = observables_[0];
        if (o.time.empty()) return;
        const std::vector<double> logged = o.time;
        std::vector<double> best_time = logged;
        Line best = strongest_line(o, prediction[0].mean);
        line_frequency_found_ = best.frequency;
        best.power *= kClearlyStronger;
        for (int phase = 0; phase < kPhases; ++phase) {
            const double late = static_cast<double>(phase) / kPhases;
            for (std::size_t i = 0; i < logged.size(); ++i)
                o.time[i] =
                    (std::floor(logged[i] * physics::kProximityRate - late) + late) / physics::kProximityRate;
            const Line line = strongest_line(o, prediction[0].mean, physics::kProximityRate / 2);
            if (line.power <= best.power) continue;
            best = line;
            best_time = o.time;
            line_frequency_found_ = line.frequency;
        }
        o.time = best_time;
    }

    /// Reflected counts of a sensor's rows before gains: the part that costs time.
    std::vector<double> see(const physics::ProximityParameters& now, std::size_t sensor,
                            double turned) const {
        std::vector<double> all;
        const double turned_cosine = std::cos(turned), turned_sine = std::sin(turned);
        for (const std::size_t i : rows_of_[sensor]) {
            const double normal =
                (distance_[i] - now.age * velocity_[i]) * cosine_[i];  // from the sensor to the wall's plane
            double seen = 0.0;
            for (std::size_t ray = i * spread_.size(); ray < (i + 1) * spread_.size(); ++ray) {
                const double cosine = turned == 0.0
                                          ? ray_cosine_[ray]
                                          : ray_cosine_[ray] * turned_cosine + ray_sine_[ray] * turned_sine;
                if (cosine < kGrazing) continue;
                const double weight =
                    now.incidence_exponent == 1.0 ? cosine : std::pow(cosine, now.incidence_exponent);
                seen += weight * physics::proximity_response(now, normal / cosine + now.distance_shift);
            }
            all.push_back(seen * reflectivity_[i] / static_cast<double>(spread_.size()));
        }
        return all;
    }

    /// About their mean; none where one is missing or all are alike.
    static void center(std::vector<double>& values) {
        const double sum = std::accumulate(values.begin(), values.end(), 0.0);
        for (double& value : values)
            value -= sum / static_cast<double>(values.size());
        if (std::ranges::none_of(values, [](double value) { return value > 0; })) values.clear();
    }

    /// Which object a row is about: as stated, else by the surface's name or its reflectivity.
    std::vector<double> objects_of(const Experiment& experiment, const std::vector<double>& stated) const {
        if (experiment.has("object")) return stated;
        std::map<std::string, double> surfaces;
        for (const Run& run : experiment.runs)
            surfaces.emplace(run.condition("surface"), static_cast<double>(surfaces.size() + 1));
        std::vector<double> objects(sensor_.size(), 1);
        if (surfaces.size() > 1) {
            for (std::size_t i = 0; i < objects.size(); ++i)
                objects[i] = surfaces.at(experiment.runs[observables_[0].run[i]].condition("surface"));
            return objects;
        }
        const auto steps = distinct(reflectivity_);
        if (steps.size() < 2 || steps.size() > kMostObjects) return objects;
        for (std::size_t i = 0; i < objects.size(); ++i)
            objects[i] =
                static_cast<double>(std::ranges::lower_bound(steps, reflectivity_[i]) - steps.begin() + 1);
        return objects;
    }

    /// `table`: the measured curve, which has no law.
    void declare_all(const std::vector<double>& objects, bool table) {
        simulated("proximity.", {"curve", "amplitude", "origin", "exponent", "saturation", "reach"});
        simulated("proximity.", {"compression", "extra_exponent", "distance_shift", "scale"});
        simulated("proximity.", {"incidence_exponent", "pair_crosstalk", "neighbour_crosstalk"});
        if (!lit(pair_)) hide("proximity.pair_crosstalk");
        if (!lit(neighbour_)) hide("proximity.neighbour_crosstalk");
        simulated("proximity.", {"warmup_gain", "warmup_time", "motor_sag", "age"});
        simulated("proximity.", {"ambient_offset", "ambient_gain", "ambient_noise", "battery_gain"});
        declare({{&ProximityNumbers::order_drift, "proximity.order_drift", "1"},
                 {&ProximityNumbers::order_zero, "proximity.order_zero", "1"}});
        // Inside a run the order goes with what was varied there, mostly the distance: with a zero of its own
        // a drift could take the place of any law.
        if (!(half_order_ > 0)) hide("proximity.order_zero");
        const std::vector<const char*> of_law{"amplitude", "origin", "exponent", "saturation"},
            of_table{"compression", "extra_exponent", "distance_shift"};
        for (const char* name : table ? of_law : of_table)
            hide(fmt::format("proximity.{}", name));
        simulated("proximity.", {"motor_noise", "proportional_noise", "threshold", "interference_rate",
                                 "interference_size", "flicker", "flicker_frequency"});
        for (const int sensor : in_order_met(sensor_))
            simulated("proximity.", {fmt::format("gain{}", sensor), fmt::format("offset{}", sensor),
                                     fmt::format("direction{}", sensor)});
        const auto kinds = distinct(objects);
        if (kinds.size() < 2) return;
        std::map<double, std::size_t> parameter;
        for (const double object : kinds)
            parameter[object] =
                add(fmt::format("object.reflectivity{}", static_cast<long>(object)), "1", 1.0);
        for (const double object : objects)
            object_.push_back(parameter.at(object));
    }

    /// Do others see light of their own that could reach a sensor: more than noise and what it casts on them?
    bool lit(const std::vector<double>& others) const {
        const std::vector<double>& own = observables_[0].y;
        const double noise = kLit * nominal().proximity.still_noise;
        std::size_t count = 0;
        for (const auto& rows : rows_of_) {
            std::vector<double> readings;
            for (const std::size_t i : rows)
                readings.push_back(others[i]);
            const double idle = stats::quantile(readings, 0.05);
            count += static_cast<std::size_t>(std::ranges::count_if(
                rows, [&](std::size_t i) { return others[i] > idle + kMostCast * own[i] + noise; }));
        }
        return static_cast<double>(count) > kLitRows * static_cast<double>(own.size());
    }

    void noise(const physics::ProximityParameters& now, Predicted& p) const {
        const std::size_t n = p.mean.size();
        const double share = now.proportional_noise, light = now.ambient_noise, rate = now.interference_rate;
        fill_rows(p.factor, n, now.motor_noise != 0.0,
                  [&](std::size_t i) { return 1 + now.motor_noise * motor_[i]; });
        fill_rows(p.extra, n, share != 0.0 || light != 0.0, [&](std::size_t i) {
            return std::sqrt(share * share * p.mean[i] * p.mean[i] + light * light * ambient_[i]);
        });
        fill_rows(p.lapse, n, rate != 0.0, [&](std::size_t i) { return std::min(rate * others_[i], 0.9); });
        p.lapse_scale.assign(p.lapse.size(), kHitSpread * now.interference_size);
        p.lapse_shift.assign(p.lapse.size(), now.interference_size);
        p.lapse_both = rate != 0.0;
        p.line_amplitude = now.flicker;
        p.line_frequency = now.flicker_frequency;
    }

    static constexpr double kLit = 4.0, kMostCast = 0.2;  // of a reading's noise, of its own light
    static constexpr double kLitRows = 0.05;              // share of the rows that are enough
    static constexpr std::size_t kOpposite = 4;  // places on the ring to the sensor lit by the same pulse
    double line_frequency_found_ = 0.0;
    double half_order_ = 0.0;  // half the range of the runs' `order`: the unit of the drift's zero
    std::array<KeyedCache<std::vector<double>>, physics::kProximitySensors> seen_;  // of a sensor's rows
    std::array<std::vector<std::size_t>, physics::kProximitySensors> rows_of_;
    std::vector<double> spread_, cosine_, ray_cosine_, ray_sine_;
    std::vector<double> distance_, angle_, reflectivity_, ambient_, pair_, neighbour_, motor_, velocity_,
        time_, others_, battery_, order_;
    std::vector<int> sensor_;
    std::vector<std::size_t> object_;  // the parameter of each row's object
    ForeignPulses pulses_;
    std::array<double, physics::kProximitySensors> angle0_{};
};

}  // namespace

std::unique_ptr<Model> make_proximity_model(const Experiment& experiment) {
    return std::make_unique<ProximityModel>(experiment);
}

}  // namespace puckloop::gap
