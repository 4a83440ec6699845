// Frames of the control loop as they reach the host. Compared are: the robot's clock with the number of
// periods, the host's clock with the robot's and the time on the wire, and whether frames were whole.
//
// Deviations: 1. the wire takes ten bit times a byte; gaps between bytes are the firmware's. 2. The clocks'
// zero is free in each run, and after each pause of the loop.

#include "gap/clean/quantum.h"
#include "gap/models/batches.h"
#include "gap/models/model_of.h"
#include "gap/models/rows.h"
#include "gap/stats/robust.h"
#include "gap/sync/sync.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace puckloop::gap {

namespace {

constexpr double kPeriod = 0.1;  // s, of the control loop
constexpr double kTick = 1e-5;   // s, no robot's clock is written finer
constexpr double kCoarse = 0.2;  // of the usual time between frames: no clock is written coarser
constexpr double kBaud = 115200;
constexpr double kBits = 10;              // a byte on the line
constexpr double kTolerance = 0.02;       // error of the rate that a receiver stands
constexpr double kLongestBatch = 0.5;     // s, looked for
constexpr double kEven = 1e-3;            // coherence that even frames lack for their clocks' rounding
constexpr double kLittle = 0.05;          // of what frames lack of keeping to a batch by themselves
constexpr double kAsGood = 0.9;           // share of the coherence that noise would leave
constexpr double kNeighbour = 1.01;       // nearer is the same peak
constexpr std::size_t kTried = 3;         // peaks
constexpr double kShortestBatch = 0.001;  // s
constexpr double kLongestAlias = 1.0;     // s: the longest that is believed of a batch
constexpr int kMostTimes = 10;            // of a batch: its multiples and parts that are tried
constexpr int kMostRates = 50;            // frame rates between two batches' rates, either way
constexpr double kRoundings = 2.0;        // of the clocks: a shorter batch is their rounding
constexpr double kFewSteps = 4.0;         // between quartiles: beyond, the middle half is the better
constexpr double kNextSteps = 1.5;        // of a clock: between its next step and the one beyond
constexpr double kWhole = 0.999;
constexpr double kEdge = 1.5e-4;       // s: how sharply a program gives up, and grids of runs are known
constexpr double kLeastFading = 1e-9;  // of what is known of a frame, to the next

struct Numbers {
    double extra_period = 0.0, period_jitter = 0.0, clock_drift = 0.0, i2c_stretch = 0.0, batch = 0.0,
           edge_errors = 0.0, overrun = 0.0, truncation = 0.0, truncation_burst = 0.0, baud_error = 0.0,
           answer_limit = 0.0;
};

class TimingModel final : public ModelOf<Numbers> {
  public:
    explicit TimingModel(const Experiment& experiment) {
        clocks_ = experiment.has("t_robot_s");
        const Rows rows(experiment, "", {"t_host_s"});
        std::vector<std::uint32_t> used;
        const Observable host = rows.observable("t_host_s", NoiseKind::Level, used);
        gather_counts(experiment, host);
        std::vector<double> bytes, baud;
        rows.take(
            used,
            {{bytes, "bytes"}, {baud, "baud", kBaud}, {reads_, "i2c_reads"}, {robot_, "t_robot_s", NAN}});
        for (std::size_t i = 0; i < bytes.size(); ++i)
            wire_.push_back(bytes[i] * kBits / baud[i]);
        if (clocks_) {
            observables_.push_back(host);
            Observable& period = observables_.back();
            period.name = "robot_clock";
            period.y = robot_;
            set_up(period, experiment);
            period.instrument.quantum = std::max(rounding_of(robot_), kTick);
            if (keeps_to_periods(period)) take_periods(period);
        } else {
            robot_ = periods_;
        }
        observables_.push_back(host);
        observables_.back().name = "arrival";
        // Against the robot's clock each arrival errs by itself; without one the periods' errors add up.
        observables_.back().noise = clocks_ ? NoiseKind::Carry : NoiseKind::Level;
        observables_.back().waits = true;
        set_up(observables_.back(), experiment);
        // Against a rounded clock an arrival is as good as both clocks are.
        double& quantum = observables_.back().instrument.quantum;
        if (quantum > kCoarse * usual_step(host.y)) quantum = 0.0;
        if (clocks_) {
            // Arrivals in batches keep to a step of their own: what is rounding, the robot's clock shows.
            rounding_ = rounding_of(robot_);
            shortest_ =
                std::max(kShortestBatch, kRoundings * std::hypot(std::min(quantum, rounding_), rounding_));
            quantum = std::hypot(quantum, rounding_);
        }
        gather_events(experiment);
        declare_all();
        apply_nominal(experiment);
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        const Numbers now = numbers(v);
        out.resize(observables_.size());
        std::size_t o = 0;
        if (clocks_) predict_clock(now, out[o++]);
        predict_arrival(now, out[o++]);
        if (ok_ >= 0) predict_frames(now, out[static_cast<std::size_t>(ok_)]);
        if (shift_ >= 0) predict_shifts(now, out[static_cast<std::size_t>(shift_)]);
    }

    /// The longest batch that intervals between arrivals keep to, and those of frames that are ready do not;
    /// then by the clock itself.
    std::vector<double> starts(std::string_view parameter) const override {
        if (parameter == "timing.answer_limit") return limits();
        if (parameter != "timing.batch") return {};
        std::vector<double> seen, expected;
        const Observable& o = arrivals();
        const std::vector<double> ready = arrivals_ready(nominal());
        for (std::size_t i = 1; i < o.y.size(); ++i)
            if (o.starts[i] == 0) {
                seen.push_back(o.y[i] - o.y[i - 1]);
                expected.push_back(ready[i] - ready[i - 1]);
            }
        std::vector<std::pair<double, double>> peaks;  // score, batch
        double least_left = kLittle, longest = 0.0;
        for (double batch = kLongestBatch; batch > shortest_; batch /= 1.003) {
            const double kept = keep_to(seen, batch), kept_anyway = std::max(keep_to(expected, batch), 0.0),
                         score = kept - kept_anyway;
            // Frames that are ready at nearly even times keep nearly to a long batch by themselves: the
            // longest that leaves little of that "nearly" has them in its hands, as its parts have.
            const double left = (1 - kept) / (1 - kept_anyway + kEven);
            if (left < least_left && (longest == 0.0 || longest < kNeighbour * batch)) {
                least_left = left;
                longest = batch;
            }
            if (!peaks.empty() && peaks.back().second < kNeighbour * batch) {
                if (score > peaks.back().first) peaks.back() = {score, batch};
            } else {
                peaks.emplace_back(score, batch);
            }
        }
        std::sort(peaks.rbegin(), peaks.rend());
        peaks.resize(std::min(peaks.size(), kTried));
        // Frames that are ready at even times keep to a batch's parts as well as to it: the finest, too.
        std::vector<double> found;
        double finest = kLongestBatch;
        for (const auto& [score, batch] : peaks) {
            found.push_back(refined(whole(seen, batch)));
            finest = std::min(finest, batch);
        }
        if (!peaks.empty()) found.push_back(refined(finest));
        if (longest > 0.0) found.push_back(refined(longest));
        const auto fine = beats_of_waits(o, ready, shortest_, std::max(usual_step(robot_), kPeriod / 10));
        found.insert(found.end(), fine.begin(), fine.end());
        return found;
    }

    /// Frames at even times meet two batches alike whose rates differ by a multiple of their own rate (as a
    /// wheel on film seems to stand), and those at times of a batch's multiple meet its parts as well.
    std::vector<double> aliases(std::string_view parameter, double value) const override {
        if (parameter != "timing.batch" || !(value > 0)) return {};
        std::vector<double> all;
        const auto take = [&](double batch) {
            if (batch < shortest_ || batch > kLongestAlias) return;
            // A rate's error is a larger share of a lower rate.
            all.push_back(is_fine_batch(batch) ? batch
                                               : nearest_beat(nearest_beat(batch, 1e-5, 30), 1e-6, 15));
        };
        for (int times = 2; times <= kMostTimes; ++times) {
            take(value * times);
            take(value / times);
        }
        const double rate = 1 / usual_step(arrivals_ready(nominal()));
        if (!std::isfinite(rate)) return all;
        for (int apart = -kMostRates; apart <= kMostRates; ++apart)
            if (const double other = 1 / value + apart * rate; apart != 0 && other > 0) take(1 / other);
        return all;
    }

  private:
    /// For each start of a batch: so many frames are broken as wait longer.
    std::vector<double> limits() const {
        const auto& whole = observables_[static_cast<std::size_t>(ok_)].y;
        const double kept =
            std::accumulate(whole.begin(), whole.end(), 0.0) / static_cast<double>(whole.size());
        std::vector<double> all = starts("timing.batch");
        for (double& one : all)
            one *= kept;
        return all;
    }

    /// A stretch's own zero: the mean of the middle half, so that no single row decides. Of rows at two
    /// neighbouring steps the quartiles are those steps: there the mean of all, drawn in to a step and a half
    /// beyond them. (Neither jumps where a row passes a limit: slopes are taken of it.)
    static double middle_of(std::vector<double> left, double quantum) {
        std::sort(left.begin(), left.end());
        const auto cut = static_cast<std::ptrdiff_t>(left.size() / 4);
        const auto from = left.begin() + cut, to = left.end() - cut;
        const double middle = std::accumulate(from, to, 0.0) / static_cast<double>(to - from);
        if (!(quantum > 0)) return middle;
        const double low = *from, high = *(to - 1), reach = kNextSteps * quantum;
        double sum = 0.0;
        for (const double one : left)
            sum += std::clamp(one, low - reach, high + reach);
        const double all = sum / static_cast<double>(left.size());
        return middle + (all - middle) * std::min(1.0, kFewSteps * quantum / std::max(high - low, quantum));
    }

    static double usual_step(const std::vector<double>& clock) {
        std::vector<double> steps;
        for (std::size_t i = 1; i < clock.size(); ++i)
            if (clock[i] > clock[i - 1]) steps.push_back(clock[i] - clock[i - 1]);
        return steps.empty() ? 0.0 : stats::upper_median(std::move(steps));
    }

    /// A clock that was read at even times keeps to its period, which is no rounding.
    static double rounding_of(const std::vector<double>& clock) {
        const double quantum = quantum_of(clock);
        return quantum > kCoarse * usual_step(clock) ? 0.0 : quantum;
    }

    const Observable& arrivals() const { return observables_[clocks_ ? 1 : 0]; }

    /// 1: all intervals are whole multiples of the batch.
    static double keep_to(const std::vector<double>& intervals, double batch) {
        double sum = 0.0;
        for (const double interval : intervals)
            sum += std::cos(2 * std::numbers::pi * interval / batch);
        return intervals.empty() ? 0.0 : sum / static_cast<double>(intervals.size());
    }

    /// What keeps to a grid keeps to its halves and thirds; noise blurs the finer ones more.
    static double whole(const std::vector<double>& seen, double batch) {
        const double kept = std::max(keep_to(seen, batch), 0.0);
        for (const int times : {5, 4, 3, 2})
            if (keep_to(seen, times * batch) > kAsGood * std::pow(kept, 1.0 / (times * times)))
                return times * batch;
        return batch;
    }

    /// The batch near by that the clock itself keeps to.
    double refined(double batch) const { return nearest_beat(nearest_beat(batch, 1e-5, 500), 1e-6, 15); }

    /// Of `reach` steps, each so much of the batch, to either side.
    double nearest_beat(double batch, double step, int reach) const {
        const double middle = batch;
        double best = 0.0;
        for (int k = -reach; k <= reach; ++k) {
            const double power = beat_of_clock(middle * (1 + step * k));
            if (power <= best) continue;
            best = power;
            batch = middle * (1 + step * k);
        }
        return batch;
    }

    double beat_of_clock(double batch) const {
        const Observable& o = arrivals();
        double power = 0.0;
        std::complex<double> sum;
        for (std::size_t i = 0; i < o.y.size(); ++i) {
            if (o.starts[i] != 0) {
                power += std::abs(sum);
                sum = {};
            }
            sum += std::polar(1.0, 2 * std::numbers::pi * o.y[i] / batch);
        }
        return power + std::abs(sum);
    }

    static void set_up(Observable& one, const Experiment& experiment) {
        one.unit = "s";
        one.time.clear();
        one.instrument = {NAN, NAN, one.instrument.quantum};
        for (std::size_t i = 1; i < one.y.size(); ++i) {
            const auto& anew = experiment.runs[one.run[i]].begun_anew;
            const bool begins = one.run[i] != one.run[i - 1] ||
                                std::binary_search(anew.begin(), anew.end(), std::size_t{one.row[i]});
            one.starts[i] = begins ? 1 : 0;
        }
    }

    /// A frame by its number, when it was due, what it takes on the wire and the transfers before it.
    struct Frame {
        double number, due, wire, reads;
    };

    void gather_counts(const Experiment& experiment, const Observable& host) {
        for (std::size_t i = 0; i < host.y.size(); ++i) {
            const auto [number, period] = frame_count(experiment.runs[host.run[i]], host.row[i]);
            periods_.push_back(number * period);
            count_.push_back(number);
        }
    }

    /// All frames, whether they arrived or not, for when each is ready.
    void gather_frames(const Experiment& experiment, const Rows& rows, const Observable& whole,
                       const std::vector<std::uint32_t>& used) {
        std::vector<double> bytes, baud, reads;
        rows.take(used, {{bytes, "bytes"}, {baud, "baud", kBaud}, {reads, "i2c_reads"}});
        for (std::size_t i = 0; i < whole.y.size(); ++i) {
            const auto [number, period] = frame_count(experiment.runs[whole.run[i]], whole.row[i]);
            frames_.push_back({number, number * period, bytes[i] * kBits / baud[i], reads[i]});
        }
    }

    /// A clock that was computed from the periods themselves has no noise that could be fitted.
    bool keeps_to_periods(const Observable& clock) const {
        double zero = 0.0;
        for (std::size_t i = 0; i < clock.y.size(); ++i) {
            if (clock.starts[i] != 0) zero = clock.y[i] - periods_[i];
            if (std::abs(clock.y[i] - periods_[i] - zero) > clock.instrument.quantum / 2) return false;
        }
        return true;
    }

    /// Its rounding measures nothing.
    void take_periods(Observable& clock) const {
        clock.fixed_sd = clock.instrument.quantum;
        double zero = 0.0;
        for (std::size_t i = 0; i < clock.y.size(); ++i) {
            if (clock.starts[i] != 0) zero = clock.y[i] - periods_[i];
            clock.y[i] = zero + periods_[i];
        }
    }

    void gather_events(const Experiment& experiment) {
        // A lost frame has no arrival.
        const Rows rows(experiment, "", {});
        std::vector<std::uint32_t> used;
        if (experiment.has("frame_ok")) {
            ok_ = static_cast<int>(observables_.size());
            // A frame that is broken because bytes shifted shows nothing that `shifted` does not.
            const auto shifted = rows.column("shifted", 0);
            observables_.push_back(rows.observable("frame_ok", NoiseKind::Event, used, shifted));
            observables_.back().time.clear();
            if (!clocks_) gather_frames(experiment, rows, observables_.back(), used);
            edges_ = taken(rows.column("edges", 0), used);
            // Whether bytes shifted is known where the column is there.
            ok_load_ = experiment.has("shifted") ? std::vector<double>(used.size(), 0.0)
                                                 : taken(rows.column("load", 0), used);
        }
        if (experiment.has("shifted")) {
            shift_ = static_cast<int>(observables_.size());
            observables_.push_back(rows.observable("shifted", NoiseKind::Event, used));
            observables_.back().time.clear();
            load_ = taken(rows.column("load", 0), used);
        }
    }

    void declare_all() {
        declare({{&Numbers::extra_period, "timing.extra_period", "s"},
                 {&Numbers::period_jitter, "timing.period_jitter", "s"},
                 {&Numbers::clock_drift, "timing.clock_drift", "1"},
                 {&Numbers::i2c_stretch, "timing.i2c_stretch", "s"},
                 {&Numbers::batch, "timing.batch", "s"},
                 {&Numbers::edge_errors, "timing.edge_errors", "1"},
                 {&Numbers::overrun, "timing.overrun", "1"},
                 {&Numbers::truncation, "timing.truncation", "1"},
                 {&Numbers::truncation_burst, "timing.truncation_burst", "1"},
                 {&Numbers::baud_error, "timing.baud_error", "1"}});
        if (!frames_.empty()) declare({{&Numbers::answer_limit, "timing.answer_limit", "s"}});
    }

    /// The first row of a run sets the zero.
    template <class Value>
    void sums(const Observable& o, std::vector<double>& mean, Value value) const {
        mean.resize(o.y.size());
        double zero = 0.0;
        for (std::size_t i = 0; i < mean.size(); ++i) {
            if (o.starts[i] != 0) zero = o.y[i] - value(i);
            mean[i] = zero + value(i);
        }
    }

    void predict_clock(const Numbers& now, Predicted& p) const {
        const double longer = now.extra_period;
        sums(observables_[0], p.mean, [&](std::size_t i) { return periods_[i] + longer * count_[i]; });
        p.extra.assign(now.period_jitter > 0 ? p.mean.size() : 0, now.period_jitter);
    }

    /// When a frame that is due by `clock` has come over the wire, up to the chain's zero.
    double ready_at(const Numbers& now, double clock, double number, double wire, double reads) const {
        const double longer = clocks_ ? 0.0 : now.extra_period, slower = 1 / (1 + now.baud_error);
        return clock * (1 + now.clock_drift) + longer * number + wire * slower + now.i2c_stretch * reads;
    }

    std::vector<double> arrivals_ready(const Numbers& now) const {
        std::vector<double> ready(arrivals().y.size());
        for (std::size_t i = 0; i < ready.size(); ++i)
            ready[i] = ready_at(now, robot_[i], count_[i], wire_[i], reads_[i]);
        return ready;
    }

    void predict_arrival(const Numbers& now, Predicted& p) const {
        const Observable& o = arrivals();
        const double batch = now.batch;
        const std::vector<double> arrival = arrivals_ready(now);
        Placed placed{arrival, {}, {}, {}};
        for (const auto& [i, end] : stretches_of(o, o.y.size())) {
            if (batch >= shortest_) {
                place_batches(o, i, end, batch, arrival, placed);
                follow_even_frames(i, end, batch, rounding_, arrival, placed);
            }
            std::vector<double> left;
            for (std::size_t k = i; k < end; ++k)
                left.push_back(o.y[k] - placed.mean[k]);
            const double zero = middle_of(std::move(left), o.instrument.quantum);
            for (std::size_t k = i; k < end; ++k)
                placed.mean[k] += zero;
        }
        p.mean = std::move(placed.mean);
        p.extra = std::move(placed.extra);
        p.chance = chances_of(placed);
    }

    /// The chance that a frame is not given up because its batch comes too late.
    std::vector<double> in_time(const Numbers& now) const {
        const Observable &whole = observables_[static_cast<std::size_t>(ok_)], &o = arrivals();
        std::vector<double> chance(whole.y.size(), 1.0);
        if (!(now.answer_limit > 0) || now.batch < shortest_ || is_fine_batch(now.batch)) return chance;
        const std::vector<double> ready = arrivals_ready(now);
        std::size_t frame = 0;
        for (const auto& [from, to] : stretches_of(o, o.y.size())) {
            const BatchGrid grid = grid_of(o, from, to, now.batch, ready);
            // Frames before a run's first arrival, and those broken behind its last, are its own as well.
            const auto before_next = [&](std::size_t i) {
                return to == o.y.size() || whole.run[i] < o.run[to] ||
                       (whole.run[i] == o.run[to] && whole.row[i] < o.row[to]);
            };
            for (; frame < chance.size() && before_next(frame); ++frame) {
                const Frame& one = frames_[frame];
                const double wait = grid.wait(ready_at(now, one.due, one.number, one.wire, one.reads));
                chance[frame] = 1 / (1 + std::exp((wait - now.answer_limit) / kEdge));
            }
        }
        return chance;
    }

    void predict_frames(const Numbers& now, Predicted& p) const {
        const Observable& o = observables_[static_cast<std::size_t>(ok_)];
        const std::vector<double> kept_in_time = in_time(now);
        const double error = std::max(now.edge_errors, 0.0), overrun = now.overrun, cut = now.truncation,
                     stays = now.truncation_burst;
        p.mean.resize(o.y.size());
        // A frame after a broken one: more likely broken too (bursts), or less. Over frames that are missing
        // the chain goes on unseen: what is known of the last one fades towards the share in the long run.
        const double again = stays > 0 ? cut + (1 - cut) * stays : cut * (1 + stays);
        const double kept = again - cut, usual = cut / std::max(1 - kept, kLeastFading);
        for (std::size_t i = 0; i < p.mean.size(); ++i) {
            double broken = cut;
            if (o.starts[i] == 0) {
                const double last = o.y[i - 1] < 0.5 ? 1.0 : 0.0;
                broken = std::clamp(usual + std::pow(kept, o.steps[i]) * (last - usual), 0.0, 1.0);
            }
            p.mean[i] = kWhole * std::pow(1 - std::min(error, 0.99), edges_[i]) *
                        (1 - std::min(overrun * ok_load_[i], 0.99)) * (1 - broken) * kept_in_time[i];
        }
    }

    void predict_shifts(const Numbers& now, Predicted& p) const {
        const double overrun = now.overrun;
        p.mean.resize(load_.size());
        for (std::size_t i = 0; i < p.mean.size(); ++i)
            p.mean[i] = 1 - kWhole + overrun * load_[i];
    }

    bool clocks_ = false;
    double rounding_ = 0.0;             // s, of the robot's clock
    double shortest_ = kShortestBatch;  // s: what is shorter is no batch but the clocks' rounding
    int ok_ = -1, shift_ = -1;
    std::vector<double> periods_, count_, wire_, reads_, robot_, edges_, ok_load_, load_;
    std::vector<Frame> frames_;  // whole or not; empty where the robot's clock says when each was ready
};

}  // namespace

std::unique_ptr<Model> make_timing_model(const Experiment& experiment) {
    return std::make_unique<TimingModel>(experiment);
}

}  // namespace puckloop::gap
