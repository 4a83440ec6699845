// Range and bearing: strength, bearing and reception of one message. Medians and spread of the strength are
// the published ones at nine distances, which the infra-red medium's default curve reproduces; ln of the
// counts is compared. Bearings are compared as errors. Every message arrives unless something here takes it.
// With "rab.ring" = 1 strength and bearing are those of the simulator's boards (rab_ring.h): uneven rings,
// light from emitter to receiver, the firmware's formulas.
//
// Deviations: 1. without the ring the receiver's own table of directions is not put in: the firmware makes
// those errors. 2. Reception is a probability; in the simulator losses emerge from frames and interrupts.

#include "gap/models/keyed_cache.h"
#include "gap/models/model_of.h"
#include "gap/models/rab_ring.h"
#include "gap/models/rows.h"
#include "physics/ir/published_strengths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <set>

namespace puckloop::gap {

namespace {

constexpr double kReception = 0.999;
constexpr double kFullScale = 4095;
constexpr std::size_t kReceivers = 12;
constexpr double kLeastGain = 0.01;
constexpr std::size_t kLeastReceivers = 3;           // with a gain: fewer show nothing of a bearing
constexpr double kReflectionTurn = 0.6;              // rad: what a reflection turns a bearing by
constexpr double kTurned = 0.66, kWholeTurn = 0.76;  // share beyond half a receiver's 30 degrees; its rms
constexpr std::size_t kLeastPiled = 5;               // equal highest strengths that look like a rail

using physics::kPublishedStrengths, physics::PublishedStrength;

double between(double PublishedStrength::*what, double distance) {
    const auto to = std::ranges::lower_bound(kPublishedStrengths, distance, {}, &PublishedStrength::distance);
    if (to == kPublishedStrengths.begin()) return to->*what;
    if (to == kPublishedStrengths.end()) return kPublishedStrengths.back().*what;
    const auto from = to - 1;
    const double share = (distance - from->distance) / (to->distance - from->distance);
    return from->*what + share * (to->*what - from->*what);
}

constexpr std::array<double, kReceivers + 1> all_one() {
    std::array<double, kReceivers + 1> ones{};
    ones.fill(1.0);
    return ones;
}

struct RabNumbers {
    /// 1: the simulator's boards; read before the fit, as `carrier` (Hz).
    double ring = 0.0, carrier = 0.0;
    /// Of receivers and emitters by their number; 0: not stated, or all.
    std::array<double, kReceivers + 1> receiver = all_one(), emitter = all_one();
    double strength_gain = 0.0, emitter_lobe = 0.0, receiver_lobe = 0.0, strength_spread = 0.0,
           far_floor = 0.0, saturation = kFullScale, multipath = 0.0, multipath_loss = 0.7,
           bearing_offset = 0.0, collisions = 0.0, random_loss = 0.0, fetch_time = 0.0, beat = 0.0,
           beat_burst = 0.5;
};

class RabModel final : public ModelOf<RabNumbers> {
  public:
    explicit RabModel(const Experiment& experiment) {
        const Rows rows(experiment, "", {"distance_m"});
        if (experiment.nominal_or("rab.ring", 0.0) != 0 && experiment.has("true_bearing_rad"))
            make_ring(rows, experiment);
        if (experiment.has("strength")) gather_strength(rows, experiment);
        if (experiment.has("bearing_rad")) gather_bearing(rows, experiment);
        if (experiment.has("received")) gather_reception(rows);
        declare_all();
        apply_nominal(experiment);
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        const RabNumbers now = numbers(v);
        out.resize(observables_.size());
        if (strength_) predict_strength(now, out[*strength_]);
        if (bearing_) predict_bearing(now, out[*bearing_]);
        if (reception_) predict_reception(now, out[*reception_]);
    }

    std::vector<double> starts(std::string_view parameter) const override {
        if (parameter == "rab.saturation" && rail_ > 0) return {rail_};
        return {};
    }

  private:
    /// The rail that the highest strengths lie at; 0 where none is to be seen.
    double rail_seen() const {
        if (!strength_) return 0.0;
        const auto& y = observables_[*strength_].y;
        const double top = std::exp(*std::ranges::max_element(y));
        const auto piled = static_cast<std::size_t>(
            std::ranges::count_if(y, [&](double one) { return std::exp(one) > top - 1; }));
        return piled < kLeastPiled || top > kFullScale - 1 ? 0.0 : top;
    }

    void make_ring(const Rows& rows, const Experiment& experiment) {
        physics::Parameters parameters;
        for (const auto& [name, value] : experiment.nominal)
            if (name.starts_with("ir.")) parameters.set(name, value);
        const auto distance = rows.column("distance_m", 0), bearing = rows.column("true_bearing_rad", 0),
                   facing = rows.column("sender_bearing_rad", NAN), emitter = rows.column("emitter", 0);
        const auto unit = rows.column("unit", NAN);
        one_unit_ = std::ranges::all_of(unit, [&](double one) { return one == unit.front(); });
        std::vector<RabLook> looks;
        for (std::size_t i = 0; i < rows.size(); ++i)
            looks.push_back({distance[i], bearing[i], facing[i], static_cast<int>(std::lround(emitter[i]))});
        ring_.emplace(std::move(looks), parameters.ir, experiment.nominal_or("rab.carrier", 0.0));
    }

    /// What drawn boards read in the rows `used`, beside their mean; nothing where all runs state one unit.
    std::vector<std::vector<double>> of_boards(double RabReading::*what,
                                               const std::vector<std::uint32_t>& used) const {
        std::vector<std::vector<double>> all;
        if (one_unit_) return all;
        for (const auto& board : ring_->drawn_boards()) {
            all.emplace_back();
            for (const std::uint32_t row : used)
                all.back().push_back(board[row].*what);
        }
        return all;
    }

    void gather_strength(const Rows& rows, const Experiment& experiment) {
        std::vector<double> distances, receiver, emitter;
        Observable one = rows.observable("strength", NoiseKind::Carry,
                                         {{distances, "distance_m"},
                                          {receiver, "receiver"},
                                          {emitter, "emitter"},
                                          {occluded_, "occluded"}},
                                         {}, &strength_row_);
        for (double& y : one.y)
            y = std::log(std::max(y, 1.0));
        one.unit = "ln counts";
        one.instrument = {one.instrument.floor > 0 ? std::log(one.instrument.floor) : NAN,
                          one.instrument.ceiling > 0 ? std::log(one.instrument.ceiling) : NAN, 0.0};
        one.known_sd = 1.0;
        for (const double distance : distances) {
            log_median_.push_back(between(&PublishedStrength::log_median, distance));
            spread_.push_back(between(&PublishedStrength::spread, distance));
        }
        if (ring_) {
            spread_ = taken(ring_->strength_sd(), strength_row_);
            one.run_draws = of_boards(&RabReading::log_strength, strength_row_);
        }
        // What is not stated cannot differ: one common gain would be the strength's scale by another name.
        if (experiment.has("receiver")) receiver_ = whole(receiver);
        if (experiment.has("emitter")) emitter_ = whole(emitter);
        strength_ = observables_.size();
        observables_.push_back(std::move(one));
    }

    void gather_bearing(const Rows& rows, const Experiment& experiment) {
        Observable one = rows.observable("bearing_rad", NoiseKind::Carry, {{truth_, "true_bearing_rad"}}, {},
                                         &bearing_row_);
        one.name = "bearing";
        one.unit = "rad";
        for (std::size_t i = 0; i < one.y.size(); ++i)
            one.y[i] = std::remainder(one.y[i] - truth_[i], 2 * std::numbers::pi);
        if (ring_) {
            bearing_factor_ = taken(ring_->bearing_sd(), bearing_row_);
            const double usual = *std::ranges::min_element(bearing_factor_);
            for (double& factor : bearing_factor_)
                factor /= usual;
            one.run_draws = of_boards(&RabReading::bearing, bearing_row_);
        }
        const physics::Parameters defaults;
        for (const double bearing : truth_)
            for (std::size_t r = 0; !ring_ && r < kReceivers && experiment.has("true_bearing_rad"); ++r) {
                const double way = defaults.ir.receiver_angle[r];
                const double facing = std::cos(bearing - way);
                const double strength = facing > 0 ? std::pow(facing, defaults.ir.receiver_exponent) : 0.0;
                lobe_.emplace_back(strength * std::cos(way), strength * std::sin(way));
            }
        bearing_ = observables_.size();
        observables_.push_back(std::move(one));
    }

    void gather_reception(const Rows& rows) {
        Observable one = rows.observable("received", NoiseKind::Event,
                                         {{senders_, "senders", 1},
                                          {frame_, "frame_time", 0.0092},
                                          {period_, "send_period", 0.02},
                                          {rate_, "arrival_rate"}});
        if (std::ranges::all_of(rate_, [](double rate) { return rate == 0; }))
            for (std::size_t i = 0; i < rate_.size(); ++i)
                rate_[i] = senders_[i] / std::max(period_[i], 1e-3);
        reception_ = observables_.size();
        observables_.push_back(std::move(one));
    }

    void declare_all() {
        declare({{&RabNumbers::strength_gain, "rab.strength_gain", "1"}});
        const std::set<int> receivers(receiver_.begin(), receiver_.end()),
            emitters(emitter_.begin(), emitter_.end());
        receivers_ = receivers.size();
        for (const int r : receivers)
            declare_part(&RabNumbers::receiver, static_cast<std::size_t>(r), "rab.receiver_gain", r, "1");
        for (const int e : emitters)
            if (!ring_ || e > 0)
                declare_part(&RabNumbers::emitter, static_cast<std::size_t>(e), "rab.emitter_gain", e, "1");
        declare({{&RabNumbers::ring, "rab.ring", "1"}, {&RabNumbers::carrier, "rab.carrier", "Hz"}});
        if (ring_) {
            declare({{&RabNumbers::emitter_lobe, "rab.emitter_lobe", "1"},
                     {&RabNumbers::receiver_lobe, "rab.receiver_lobe", "1"}});
            parameters_[*find("rab.emitter_lobe")].neutral = ring_->neutral().emitter_lobe;
            parameters_[*find("rab.receiver_lobe")].neutral = ring_->neutral().receiver_lobe;
        }
        declare({{&RabNumbers::strength_spread, "rab.strength_spread", "1"},
                 {&RabNumbers::far_floor, "rab.far_floor", "counts"},
                 {&RabNumbers::saturation, "rab.saturation", "counts"},
                 {&RabNumbers::multipath, "rab.multipath", "1"},
                 {&RabNumbers::multipath_loss, "rab.multipath_loss", "ln counts"},
                 {&RabNumbers::bearing_offset, "rab.bearing_offset", "rad"},
                 {&RabNumbers::collisions, "rab.collisions", "1"},
                 {&RabNumbers::random_loss, "rab.random_loss", "1"},
                 {&RabNumbers::fetch_time, "rab.fetch_time", "s"},
                 {&RabNumbers::beat, "rab.beat", "1"},
                 {&RabNumbers::beat_burst, "rab.beat_burst", "s"}});
        rail_ = rail_seen();
        if (!(rail_ > 0)) hide("rab.saturation");  // a rail that no strength lies at has no say
    }

    /// ln of each gain; a part that gives next to nothing is not taken for one that gives nothing.
    static std::array<double, kReceivers + 1> logs_of(std::array<double, kReceivers + 1> gains) {
        for (double& gain : gains)
            gain = std::log(std::max(gain, kLeastGain));
        return gains;
    }

    std::shared_ptr<const std::vector<RabReading>> ring_readings(const RabNumbers& now) const {
        RabParts parts = ring_->neutral();
        for (std::size_t k = 0; k < kReceivers; ++k) {
            parts.receiver[k] = std::max(now.receiver[k + 1], kLeastGain);
            parts.emitter[k] = std::max(now.emitter[k + 1], kLeastGain);
        }
        // What all emitters have in common cannot be parted from what all receivers have.
        double mean = 0.0;
        for (const double gain : parts.emitter)
            mean += std::log(gain) / kReceivers;
        for (double& gain : parts.emitter)
            gain /= std::exp(mean);
        parts.emitter_lobe = now.emitter_lobe;
        parts.receiver_lobe = now.receiver_lobe;
        return ring_->readings(parts);
    }

    void predict_strength(const RabNumbers& now, Predicted& p) const {
        const std::size_t n = log_median_.size();
        p.mean.resize(n);
        p.factor = spread_;
        const double other = now.multipath;
        const auto of_ring = ring_ ? ring_readings(now) : nullptr;
        const auto receivers = logs_of(now.receiver), emitters = logs_of(now.emitter);
        for (std::size_t i = 0; i < n; ++i) {
            double level = now.strength_gain;
            if (ring_) {
                level += (*of_ring)[strength_row_[i]].log_strength;
            } else {
                level += log_median_[i];
                if (!receiver_.empty()) level += receivers[static_cast<std::size_t>(receiver_[i])];
                if (!emitter_.empty()) level += emitters[static_cast<std::size_t>(emitter_[i])];
            }
            if (now.far_floor > 0) level = std::max(level, std::log(now.far_floor));
            p.mean[i] = level;
            p.factor[i] *= 1 + now.strength_spread;
        }
        // The detector's rail cuts each message's strength, with what chance added to it.
        p.ceiling = now.saturation < kFullScale - 1 ? std::log(now.saturation) : 0.0;
        p.pile = 1 / now.saturation;
        p.lapse.assign(other > 0 ? n : 0, other);
        p.lapse_scale.assign(other > 0 ? n : 0, 0.3);
        p.lapse_shift.assign(p.lapse.size(), -now.multipath_loss);
        if (other > 0 && std::ranges::any_of(occluded_, [](double o) { return o > 0; }))
            for (std::size_t i = 0; i < n; ++i)
                p.lapse[i] = other * (occluded_[i] > 0 ? 1.0 : 0.05);
    }

    void predict_bearing(const RabNumbers& now, Predicted& p) const {
        const std::size_t n = observables_[*bearing_].y.size();
        const double other = now.multipath;
        p.mean.assign(n, now.bearing_offset);
        // The simulator's reflections turn by whole receivers, a third of them by none
        // (physics/ir/burst_outcomes).
        p.lapse.assign(other > 0 ? n : 0, ring_ ? kTurned * other : other);
        p.lapse_scale.assign(other > 0 ? n : 0, ring_ ? kWholeTurn : kReflectionTurn);
        if (ring_) {
            p.factor = bearing_factor_;
            const auto all = ring_readings(now);
            for (std::size_t i = 0; i < n; ++i)
                p.mean[i] +=
                    std::remainder((*all)[bearing_row_[i]].bearing - truth_[i], 2 * std::numbers::pi);
            return;
        }
        if (receivers_ < kLeastReceivers || lobe_.empty()) return;
        const std::vector<double> gain(now.receiver.begin() + 1, now.receiver.end());
        const auto pull = pull_.get(gain, [&] { return pull_of(gain, n); });
        for (std::size_t i = 0; i < n; ++i)
            p.mean[i] += (*pull)[i];
    }

    /// How far unequal receivers turn the sum of what they measure, by which the board finds bearings.
    std::vector<double> pull_of(const std::vector<double>& gain, std::size_t n) const {
        std::vector<double> pull(n);
        for (std::size_t i = 0; i < n; ++i) {
            std::complex<double> sum, equal;
            for (std::size_t r = 0; r < kReceivers; ++r) {
                equal += lobe_[i * kReceivers + r];
                sum += gain[r] * lobe_[i * kReceivers + r];
            }
            pull[i] = std::arg(sum * std::conj(equal));
        }
        return pull;
    }

    void predict_reception(const RabNumbers& now, Predicted& p) const {
        const Observable& o = observables_[*reception_];
        const std::size_t n = o.y.size();
        p.mean.resize(n);
        const double fetch = now.fetch_time, beat = now.beat;
        for (std::size_t i = 0; i < n; ++i) {
            double arrives = kReception * (1 - now.random_loss) *
                             std::exp(-2 * now.collisions * std::max(senders_[i] - 1, 0.0) * frame_[i] /
                                      std::max(period_[i], 1e-4));
            if (fetch > 0) arrives *= std::min(1.0, 1 / std::max(rate_[i] * fetch, 1e-6));
            if (beat > 0) {  // losses in bursts: what happened before bears on now
                double lost = beat;
                if (o.starts[i] == 0 && !o.time.empty()) {
                    const double forget = std::exp(-(o.time[i] - o.time[i - 1]) / now.beat_burst);
                    lost = o.y[i - 1] < 0.5 ? beat + (1 - beat) * forget : beat * (1 - forget);
                }
                arrives *= 1 - lost;
            }
            p.mean[i] = arrives;
        }
    }

    std::optional<RabRing> ring_;  // of all rows
    bool one_unit_ = false;        // the same pair of boards in all runs
    std::vector<std::uint32_t> strength_row_, bearing_row_;
    std::vector<double> truth_, bearing_factor_;
    double rail_ = 0.0;                       // counts
    std::vector<std::complex<double>> lobe_;  // of the receivers in turn, for each bearing
    KeyedCache<std::vector<double>> pull_;    // of each bearing, by the receivers' gains
    std::vector<double> log_median_, spread_, occluded_, senders_, frame_, period_, rate_;
    std::vector<int> receiver_, emitter_;
    std::size_t receivers_ = 0;                                  // that messages state
    std::optional<std::size_t> strength_, bearing_, reception_;  // of the observables
};

}  // namespace

std::unique_ptr<Model> make_rab_model(const Experiment& experiment) {
    return std::make_unique<RabModel>(experiment);
}

}  // namespace puckloop::gap
