// Frames of the control loop as they reach the host. Compared are: the robot's clock with the number of
// periods, the host's clock with the robot's and the time on the wire, and whether frames were whole.
//
// Deviations: 1. the wire takes ten bit times a byte; gaps between bytes are the firmware's. 2. The clocks'
// zero is free in each run, and after each pause of the loop. 3. How far arrivals follow what single readings
// of the robot's clock stray by is each run's own: by 0 (it was misread) to 1 (the loop strays).

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
#include <optional>

namespace puckloop::gap {

namespace {

constexpr double kPeriod = 0.1;  // s, of the control loop
constexpr double kTick = 1e-5;   // s, no robot's clock is written finer
constexpr double kCoarse = 0.2;  // of the usual time between frames: no clock is written coarser
constexpr double kBaud = 115200;
constexpr double kBits = 10;              // a byte on the line
constexpr double kLongestBatch = 0.5;     // s, looked for
constexpr double kEven = 1e-3;            // coherence that even frames lack for their clocks' rounding
constexpr double kLittle = 0.05;          // of what frames lack of keeping to a batch by themselves
constexpr double kAsGood = 0.9;           // share of the coherence that noise would leave
constexpr double kNeighbour = 1.01;       // nearer is the same peak
constexpr std::size_t kPeaksTried = 3;    // peaks
constexpr double kShortestBatch = 0.001;  // s
constexpr double kLongestAlias = 1.0;     // s: the longest that is believed of a batch
constexpr int kMostTimes = 10;            // of a batch: its multiples and parts that are tried
constexpr int kMostRates = 50;            // frame rates between two batches' rates, either way
constexpr double kRoundings = 2.0;        // of the clocks: a shorter batch is their rounding
constexpr double kFewSteps = 4.0;         // between quartiles: beyond, the middle half is the better
constexpr double kNextSteps = 1.5;        // of a clock: between its next step and the one beyond
constexpr double kWhole = 0.999;
constexpr double kGivingUpEdge = 1.5e-4;  // s: how sharply a program gives up, and grids of runs are known
constexpr std::size_t kAround = 4;        // rows to either side: what errs by itself is no part of their line
constexpr double kLeastFading = 1e-9;     // of what is known of a frame, to the next

struct TimingNumbers {
    double extra_period = 0.0, period_jitter = 0.0, clock_drift = 0.0, i2c_stretch = 0.0, batch = 0.0,
           edge_errors = 0.0, overrun = 0.0, truncation = 0.0, truncation_burst = 0.0, baud_error = 0.0,
           answer_limit = 0.0;
};

class TimingModel final : public ModelOf<TimingNumbers> {
  public:
    explicit TimingModel(const Experiment& experiment) {
        clocks_ = experiment.has("t_robot_s");
        const Rows rows(experiment, "", {"t_host_s"});
        Line line;
        const Observable host = rows.observable("t_host_s", NoiseKind::Level,
                                                {{line.bytes, "bytes"},
                                                 {line.baud, "baud", kBaud},
                                                 {line.reads, "i2c_reads"},
                                                 {robot_, "t_robot_s", NAN}});
        arrived_ = frames_of(experiment, host, line);
        if (clocks_) {
            observables_.push_back(host);
            Observable& period = observables_.back();
            period.name = "robot_clock";
            period.y = robot_;
            set_up(period, experiment);
            period.instrument.quantum = std::max(rounding_of(robot_), kTick);
            take_periods(period);
        } else {
            std::ranges::transform(arrived_, robot_.begin(), &Frame::due);
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
        find_strays();
        gather_events(experiment);
        declare_all();
        apply_nominal(experiment);
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        const TimingNumbers now = numbers(v);
        out.resize(observables_.size());
        std::size_t o = 0;
        if (clocks_) predict_clock(now, out[o++]);
        predict_arrival(now, out[o++]);
        if (ok_) predict_frames(now, out[*ok_]);
        if (shift_) predict_shifts(now, out[*shift_]);
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
        peaks.resize(std::min(peaks.size(), kPeaksTried));
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
        const double kept = stats::mean(observables_[*ok_].y);
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
            if (std::ranges::binary_search(anew, std::size_t{one.row[i]})) one.starts[i] = 1;
        }
    }

    /// A frame by its number, when it was due by its periods, what it takes on the wire and the transfers
    /// before it.
    struct Frame {
        double number, due, wire, reads;
    };
    /// Columns of what is on the wire.
    struct Line {
        std::vector<double> bytes, baud, reads;
    };

    static std::vector<Frame> frames_of(const Experiment& experiment, const Observable& rows,
                                        const Line& line) {
        std::vector<Frame> frames;
        for (std::size_t i = 0; i < rows.y.size(); ++i) {
            const auto [number, period] = frame_count(experiment.runs[rows.run[i]], rows.row[i]);
            frames.push_back({number, number * period, line.bytes[i] * kBits / line.baud[i], line.reads[i]});
        }
        return frames;
    }

    /// A clock that was computed from the periods themselves has no noise that could be fitted, and its
    /// rounding measures nothing.
    void take_periods(Observable& clock) const {
        double zero = 0.0, off = 0.0;
        std::vector<double> kept;
        for (std::size_t i = 0; i < clock.y.size(); ++i) {
            if (clock.starts[i] != 0) zero = clock.y[i] - arrived_[i].due;
            off = std::max(off, std::abs(clock.y[i] - arrived_[i].due - zero));
            kept.push_back(zero + arrived_[i].due);
        }
        if (off > clock.instrument.quantum / 2) return;
        clock.fixed_sd = clock.instrument.quantum;
        clock.y = kept;
    }

    /// By how much each reading of the robot's clock lies off a line through those around it.
    void find_strays() {
        stray_.assign(robot_.size(), 0.0);
        for (const auto& [from, to] : stretches_of(observables_.back(), robot_.size()))
            for (std::size_t i = from; clocks_ && i < to; ++i) {
                double rows = 0.0, number = 0.0, clock = 0.0, squares = 0.0, product = 0.0;
                const std::size_t end = std::min(to, i + kAround + 1);
                for (std::size_t k = std::max(from + kAround, i) - kAround; k < end; ++k) {
                    if (k == i) continue;
                    const double n = arrived_[k].number - arrived_[i].number, r = robot_[k] - robot_[i];
                    rows += 1;
                    number += n;
                    clock += r;
                    squares += n * n;
                    product += n * r;
                }
                const double spread = rows * squares - number * number;
                if (spread > 0) stray_[i] = (product * number - clock * squares) / spread;
            }
    }

    void gather_events(const Experiment& experiment) {
        // A lost frame has no arrival.
        const Rows rows(experiment, "", {});
        if (experiment.has("frame_ok")) {
            ok_ = observables_.size();
            Line line;
            // A frame that is broken because bytes shifted shows nothing that `shifted` does not.
            observables_.push_back(rows.observable("frame_ok", NoiseKind::Event,
                                                   {{line.bytes, "bytes"},
                                                    {line.baud, "baud", kBaud},
                                                    {line.reads, "i2c_reads"},
                                                    {edges_, "edges"},
                                                    {ok_load_, "load"}},
                                                   rows.column("shifted", 0)));
            observables_.back().time.clear();
            if (!clocks_) frames_ = frames_of(experiment, observables_.back(), line);
            // Whether bytes shifted is known where the column is there.
            if (experiment.has("shifted")) ok_load_.assign(ok_load_.size(), 0.0);
        }
        if (experiment.has("shifted")) {
            shift_ = observables_.size();
            observables_.push_back(rows.observable("shifted", NoiseKind::Event, {{load_, "load"}}));
            observables_.back().time.clear();
        }
    }

    void declare_all() {
        declare({{&TimingNumbers::extra_period, "timing.extra_period", "s"},
                 {&TimingNumbers::period_jitter, "timing.period_jitter", "s"},
                 {&TimingNumbers::clock_drift, "timing.clock_drift", "1"},
                 {&TimingNumbers::i2c_stretch, "timing.i2c_stretch", "s"},
                 {&TimingNumbers::batch, "timing.batch", "s"},
                 {&TimingNumbers::edge_errors, "timing.edge_errors", "1"},
                 {&TimingNumbers::overrun, "timing.overrun", "1"},
                 {&TimingNumbers::truncation, "timing.truncation", "1"},
                 {&TimingNumbers::truncation_burst, "timing.truncation_burst", "1"},
                 {&TimingNumbers::baud_error, "timing.baud_error", "1"}});
        if (!frames_.empty()) declare({{&TimingNumbers::answer_limit, "timing.answer_limit", "s"}});
    }

    /// The first row of a run sets the zero.
    void predict_clock(const TimingNumbers& now, Predicted& p) const {
        const Observable& o = observables_[0];
        p.mean.resize(o.y.size());
        double zero = 0.0;
        for (std::size_t i = 0; i < p.mean.size(); ++i) {
            const double due = arrived_[i].due + now.extra_period * arrived_[i].number;
            if (o.starts[i] != 0) zero = o.y[i] - due;
            p.mean[i] = zero + due;
        }
        p.extra.assign(now.period_jitter > 0 ? p.mean.size() : 0, now.period_jitter);
    }

    /// What a frame takes after the loop has begun on it.
    static double handling_of(const TimingNumbers& now, const Frame& one) {
        return one.wire / (1 + now.baud_error) + now.i2c_stretch * one.reads;
    }

    /// When a frame that is due by `clock` has come over the wire, up to the chain's zero.
    double ready_at(const TimingNumbers& now, double clock, const Frame& one) const {
        const double longer = clocks_ ? 0.0 : now.extra_period;
        return clock * (1 + now.clock_drift) + longer * one.number + handling_of(now, one);
    }

    std::vector<double> arrivals_ready(const TimingNumbers& now) const {
        std::vector<double> ready(arrivals().y.size());
        for (std::size_t i = 0; i < ready.size(); ++i)
            ready[i] = ready_at(now, robot_[i], arrived_[i]);
        // What a clock was read late by, or early, is none of the frame's: its run's arrivals do not follow
        // it (errors in variables: the share that they do not follow is the slope of one's steps on the
        // other's).
        const Observable& o = arrivals();
        for (const auto& [from, to] : stretches_of(o, o.y.size())) {
            double product = 0.0, squares = 0.0;
            for (std::size_t k = from + 1; k < to; ++k) {
                const double stray = stray_[k] - stray_[k - 1];
                product += stray * (o.y[k] - o.y[k - 1] - ready[k] + ready[k - 1]);
                squares += stray * stray;
            }
            const bool enough = squares > 0 && to - from > 2 * kAround;
            const double misread = enough ? std::clamp(product / squares, -1.0, 0.0) : 0.0;
            for (std::size_t k = from; k < to; ++k)
                ready[k] += misread * stray_[k];
        }
        return ready;
    }

    void predict_arrival(const TimingNumbers& now, Predicted& p) const {
        const Observable& o = arrivals();
        const double batch = now.batch;
        const std::vector<double> arrival = arrivals_ready(now);
        const bool fine = batch >= shortest_ && is_fine_batch(batch);
        std::vector<double> begun;  // asked of fine batches only
        for (std::size_t k = 0; fine && k < arrival.size(); ++k)
            begun.push_back(arrival[k] - handling_of(now, arrived_[k]));
        Placed placed{arrival, {}, {}, {}};
        for (const auto& [i, end] : stretches_of(o, o.y.size())) {
            if (batch >= shortest_) {
                place_batches(o, i, end, batch, arrival, placed);
                follow_even_frames(i, end, batch, rounding_, arrival, placed);
                if (fine) pass_over_locked(i, end, batch, begun, arrival, placed);
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
    std::vector<double> in_time(const TimingNumbers& now) const {
        const Observable &whole = observables_[*ok_], &o = arrivals();
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
                const double wait = grid.wait(ready_at(now, one.due, one));
                chance[frame] = 1 / (1 + std::exp((wait - now.answer_limit) / kGivingUpEdge));
            }
        }
        return chance;
    }

    void predict_frames(const TimingNumbers& now, Predicted& p) const {
        const Observable& o = observables_[*ok_];
        const std::vector<double> kept_in_time = in_time(now);
        const double error = std::max(now.edge_errors, 0.0), cut = now.truncation,
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
                        (1 - std::min(now.overrun * ok_load_[i], 0.99)) * (1 - broken) * kept_in_time[i];
        }
    }

    void predict_shifts(const TimingNumbers& now, Predicted& p) const {
        fill_rows(p.mean, load_.size(), true,
                  [&](std::size_t i) { return 1 - kWhole + now.overrun * load_[i]; });
    }

    bool clocks_ = false;
    double rounding_ = 0.0;                  // s, of the robot's clock
    double shortest_ = kShortestBatch;       // s: what is shorter is no batch but the clocks' rounding
    std::optional<std::size_t> ok_, shift_;  // of the observables
    std::vector<double> robot_;              // s, the clock by which frames that arrived were due
    std::vector<double> stray_;              // s, of each row: robot_ less the clock's course near by
    std::vector<double> edges_, ok_load_, load_;
    std::vector<Frame> arrived_;
    std::vector<Frame> frames_;  // all, whole or not; empty where the robot's clock says when each was ready
};

}  // namespace

std::unique_ptr<Model> make_timing_model(const Experiment& experiment) {
    return std::make_unique<TimingModel>(experiment);
}

}  // namespace puckloop::gap
