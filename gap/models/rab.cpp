// Range and bearing: strength, bearing and reception of one message. Medians and spread of the strength are
// the published ones at nine distances, which the infra-red medium's default curve reproduces; ln of the
// counts is compared. Bearings are compared as errors. Every message arrives unless something here takes it.
//
// Deviations: 1. the receiver's own table of directions is not put in: the firmware makes those errors.
// 2. Reception is a probability; in the simulator losses emerge from frames and interrupts.

#include "gap/models/model.h"
#include "gap/models/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

struct Measured {
    double distance, log_median, spread;
};
/// Medians and sds of ln(counts), measured between two boards (argos3-epuck).
constexpr Measured kTable[] = {
    {0.00, 7.64689, 0.357061}, {0.02, 7.59652, 0.319231}, {0.05, 7.24955, 0.192649},
    {0.10, 7.08464, 0.15294},  {0.15, 6.9845, 0.109233},  {0.30, 6.91745, 0.121653},
    {0.45, 6.82319, 0.153155}, {0.60, 6.82855, 0.141843}, {0.80, 6.82855, 0.141843}};
constexpr double kReception = 0.999;
constexpr double kFullScale = 4095;

double between(double Measured::*what, double distance) {
    if (distance <= kTable[0].distance) return kTable[0].*what;
    for (std::size_t i = 1; i < std::size(kTable); ++i)
        if (distance <= kTable[i].distance) {
            const double share =
                (distance - kTable[i - 1].distance) / (kTable[i].distance - kTable[i - 1].distance);
            return kTable[i - 1].*what + share * (kTable[i].*what - kTable[i - 1].*what);
        }
    return std::end(kTable)[-1].*what;
}

class RabModel final : public Model {
  public:
    explicit RabModel(const Experiment& experiment) {
        const Rows rows(experiment, "", {"distance_m"});
        if (experiment.has("strength")) gather_strength(rows);
        if (experiment.has("bearing_rad")) gather_bearing(rows);
        if (experiment.has("received")) gather_reception(rows);
        declare();
        apply_nominal(experiment);
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        out.resize(observables_.size());
        if (strength_ >= 0) predict_strength(v, out[static_cast<std::size_t>(strength_)]);
        if (bearing_ >= 0) predict_bearing(v, out[static_cast<std::size_t>(bearing_)]);
        if (reception_ >= 0) predict_reception(v, out[static_cast<std::size_t>(reception_)]);
    }

  private:
    static double at(const std::vector<double>& v, int index) {
        return index < 0 ? 0.0 : v[static_cast<std::size_t>(index)];
    }

    static std::vector<int> whole(const std::vector<double>& values) {
        std::vector<int> out;
        for (const double value : values)
            out.push_back(static_cast<int>(std::lround(value)));
        return out;
    }

    void gather_strength(const Rows& rows) {
        std::vector<std::uint32_t> used;
        Observable one = rows.observable("strength", NoiseKind::Carry, used);
        for (double& y : one.y)
            y = std::log(std::max(y, 1.0));
        one.unit = "ln counts";
        one.instrument = {one.instrument.floor > 0 ? std::log(one.instrument.floor) : NAN,
                          one.instrument.ceiling > 0 ? std::log(one.instrument.ceiling) : NAN, 0.0};
        one.known_sd = 1.0;
        for (const double distance : taken(rows.column("distance_m", 0), used)) {
            log_median_.push_back(between(&Measured::log_median, distance));
            spread_.push_back(between(&Measured::spread, distance));
        }
        receiver_ = whole(taken(rows.column("receiver", 0), used));
        emitter_ = whole(taken(rows.column("emitter", 0), used));
        occluded_ = taken(rows.column("occluded", 0), used);
        strength_ = static_cast<int>(observables_.size());
        observables_.push_back(std::move(one));
    }

    void gather_bearing(const Rows& rows) {
        std::vector<std::uint32_t> used;
        Observable one = rows.observable("bearing_rad", NoiseKind::Carry, used);
        one.name = "bearing";
        one.unit = "rad";
        const auto truth = taken(rows.column("true_bearing_rad", 0), used);
        for (std::size_t i = 0; i < one.y.size(); ++i)
            one.y[i] = std::remainder(one.y[i] - truth[i], 2 * std::numbers::pi);
        bearing_receiver_ = whole(taken(rows.column("receiver", 0), used));
        bearing_ = static_cast<int>(observables_.size());
        observables_.push_back(std::move(one));
    }

    void gather_reception(const Rows& rows) {
        std::vector<std::uint32_t> used;
        Observable one = rows.observable("received", NoiseKind::Event, used);
        senders_ = taken(rows.column("senders", 1), used);
        frame_ = taken(rows.column("frame_time", 0.0092), used);
        period_ = taken(rows.column("send_period", 0.02), used);
        rate_ = taken(rows.column("arrival_rate", 0), used);
        if (std::all_of(rate_.begin(), rate_.end(), [](double rate) { return rate == 0; }))
            for (std::size_t i = 0; i < rate_.size(); ++i)
                rate_[i] = senders_[i] / std::max(period_[i], 1e-3);
        reception_ = static_cast<int>(observables_.size());
        observables_.push_back(std::move(one));
    }

    void declare() {
        gain_ = add("rab.strength_gain", "1", 0.0);
        for (const int r : distinct_of(receiver_))
            receiver_gain_.emplace_back(r, add(fmt::format("rab.receiver_gain{}", r), "1", 1.0));
        for (const int e : distinct_of(emitter_))
            emitter_gain_.emplace_back(e, add(fmt::format("rab.emitter_gain{}", e), "1", 1.0));
        more_spread_ = add("rab.strength_spread", "1", 0.0);
        far_floor_ = add("rab.far_floor", "counts", 0.0);
        saturation_ = add("rab.saturation", "counts", kFullScale);
        multipath_ = add("rab.multipath", "1", 0.0);
        multipath_loss_ = add("rab.multipath_loss", "ln counts", 0.7);
        offset_ = add("rab.bearing_offset", "rad", 0.0);
        collisions_ = add("rab.collisions", "1", 0.0);
        loss_ = add("rab.random_loss", "1", 0.0);
        fetch_ = add("rab.fetch_time", "s", 0.0);
        beat_ = add("rab.beat", "1", 0.0);
        burst_ = add("rab.beat_burst", "s", 0.5);
    }

    static std::vector<int> distinct_of(std::vector<int> values) {
        std::sort(values.begin(), values.end());
        values.erase(std::unique(values.begin(), values.end()), values.end());
        return values;
    }

    static double of(const std::vector<std::pair<int, int>>& gains, int which, const std::vector<double>& v) {
        for (const auto& [number, index] : gains)
            if (number == which) return v[static_cast<std::size_t>(index)];
        return 1.0;
    }

    void predict_strength(const std::vector<double>& v, Predicted& p) const {
        const std::size_t n = log_median_.size();
        p.mean.resize(n);
        p.factor = spread_;
        const double more = 1 + at(v, more_spread_), gain = at(v, gain_), low = at(v, far_floor_),
                     high = std::log(at(v, saturation_));
        const double other = at(v, multipath_);
        for (std::size_t i = 0; i < n; ++i) {
            double level = log_median_[i] + gain +
                           std::log(std::max(of(receiver_gain_, receiver_[i], v), 0.01)) +
                           std::log(std::max(of(emitter_gain_, emitter_[i], v), 0.01));
            level = std::min(level, high);
            if (low > 0) level = std::max(level, std::log(low));
            p.mean[i] = level;
            p.factor[i] *= more;
        }
        p.lapse.assign(other > 0 ? n : 0, other);
        p.lapse_scale.assign(other > 0 ? n : 0, 0.3);
        p.lapse_shift = other > 0 ? -at(v, multipath_loss_) : 0.0;
        if (other > 0 && std::any_of(occluded_.begin(), occluded_.end(), [](double o) { return o > 0; }))
            for (std::size_t i = 0; i < n; ++i)
                p.lapse[i] = other * (occluded_[i] > 0 ? 1.0 : 0.05);
    }

    void predict_bearing(const std::vector<double>& v, Predicted& p) const {
        const std::size_t n = bearing_receiver_.size();
        const double other = at(v, multipath_);
        p.mean.assign(n, at(v, offset_));
        p.lapse.assign(other > 0 ? n : 0, other);
        p.lapse_scale.assign(other > 0 ? n : 0, 0.6);
        const int around = 12;
        if (receiver_gain_.size() < 3) return;
        for (std::size_t i = 0; i < n; ++i) {  // a louder neighbour draws the vector sum towards it
            const int r = bearing_receiver_[i];
            if (r < 1) continue;
            p.mean[i] +=
                kPull * (std::log(std::max(of(receiver_gain_, r % around + 1, v), 0.01)) -
                         std::log(std::max(of(receiver_gain_, (r + around - 2) % around + 1, v), 0.01)));
        }
    }

    void predict_reception(const std::vector<double>& v, Predicted& p) const {
        const Observable& o = observables_[static_cast<std::size_t>(reception_)];
        const std::size_t n = o.y.size();
        p.mean.resize(n);
        const double collisions = at(v, collisions_), kept = 1 - at(v, loss_), fetch = at(v, fetch_),
                     beat = at(v, beat_), burst = at(v, burst_);
        for (std::size_t i = 0; i < n; ++i) {
            double arrives = kReception * kept *
                             std::exp(-2 * collisions * std::max(senders_[i] - 1, 0.0) * frame_[i] /
                                      std::max(period_[i], 1e-4));
            if (fetch > 0) arrives *= std::min(1.0, 1 / std::max(rate_[i] * fetch, 1e-6));
            if (beat > 0) {  // lost spells: what happened before says much about now
                double lost = beat;
                if (o.starts[i] == 0 && !o.time.empty()) {
                    const double forget = std::exp(-(o.time[i] - o.time[i - 1]) / burst);
                    lost = o.y[i - 1] < 0.5 ? beat + (1 - beat) * forget : beat * (1 - forget);
                }
                arrives *= 1 - lost;
            }
            p.mean[i] = arrives;
        }
    }

    static constexpr double kPull =
        0.25;  // rad a unit of ln gain: two receivers 30 degrees apart, cosine lobes

    std::vector<double> log_median_, spread_, occluded_, senders_, frame_, period_, rate_;
    std::vector<int> receiver_, emitter_, bearing_receiver_;
    std::vector<std::pair<int, int>> receiver_gain_, emitter_gain_;
    int strength_ = -1, bearing_ = -1, reception_ = -1;
    int gain_ = -1, more_spread_ = -1, far_floor_ = -1, saturation_ = -1, multipath_ = -1,
        multipath_loss_ = -1, offset_ = -1, collisions_ = -1, loss_ = -1, fetch_ = -1, beat_ = -1,
        burst_ = -1;
};

}  // namespace

std::unique_ptr<Model> make_rab_model(const Experiment& experiment) {
    return std::make_unique<RabModel>(experiment);
}

}  // namespace puckloop::gap
