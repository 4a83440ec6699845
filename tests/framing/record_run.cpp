#include "tests/framing/record_run.h"

#include "base/random.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

namespace puckloop::framing {

namespace {

constexpr double kPeriod = 0.1;     // s, of control
constexpr double kGrain = 0.0005;   // s between looks at the motors
constexpr double kRounding = 1e-9;  // picoseconds against doubles
constexpr double kFcy = 14'745'600;
constexpr double kSameSpeed = 0.03;  // the timers' whole counts: up to 2 % at 1000 steps/s
constexpr double kHandling = 0.03;   // s from a control step to wheels that obey it, and some more

/// Steps/s that a motor's timer makes now, without a sign.
double speed_of(dspic::Chip& chip, const char* control, const char* period) {
    const unsigned con = chip.peek(control);
    if (!(con & 0x8000)) return 0;
    constexpr std::array<double, 4> kPrescalers{1, 8, 64, 256};
    return kFcy / kPrescalers[con >> 4 & 3] / (chip.peek(period) + 1.0);
}

/// A new pair of speeds at each step; each wheel keeps its sense of turning for the session.
class Drawn : public control::Behaviour {
  public:
    explicit Drawn(std::uint64_t seed) : random_(seed, "record run") {
        for (double& sign : signs_)
            sign = random_.below(2) ? 1 : -1;
    }
    control::Actuators step(const control::Sensors& sensors, double) override {
        seen_.push_back(sensors);
        const double left = signs_[0] * draw(), right = signs_[1] * draw();
        return {.left_mm_s = left * control::kMillimetresPerStep,
                .right_mm_s = right * control::kMillimetresPerStep,
                .ring_leds = static_cast<std::uint8_t>(random_.below(256))};
    }
    const std::array<double, 2>& signs() const { return signs_; }
    /// Steps with a value far from what the robot, which sees the same all the time, usually has.
    int seen_wrong() const {
        constexpr double kFar = 48;  // counts of the converter
        int wrong = 0;
        for (const control::Sensors& sensors : seen_) {
            bool far = false;
            for (std::size_t i = 0; i < sensors.proximity.size(); ++i) {
                far = far || std::abs(sensors.proximity[i] - usual(&control::Sensors::proximity, i)) > kFar;
                far = far || std::abs(sensors.light[i] - usual(&control::Sensors::light, i)) > kFar;
            }
            wrong += far;
        }
        return wrong;
    }

  private:
    double usual(std::array<double, 8> control::Sensors::*values, std::size_t i) const {
        std::vector<double> all;
        for (const control::Sensors& sensors : seen_)
            all.push_back((sensors.*values)[i]);
        std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
        return all[all.size() / 2];
    }
    double draw() { return 60 + static_cast<double>(random_.below(800)); }
    RandomStream random_;
    std::array<double, 2> signs_{};
    std::vector<control::Sensors> seen_;
};

/// The wheels against the actuator records that the program meant to send.
class Watch {
  public:
    Watch(exec::Rig& rig, const std::array<double, 2>& signs) : rig_(rig), signs_(signs) {
        for (std::size_t i = 0; i < 2; ++i)
            position_[i] = rig_.get(kWheel[i]);
    }
    /// The program began to send a record with these speeds.
    void commanded(double now, std::int16_t left, std::int16_t right) {
        if (commands_.size() == 2) commands_.pop_front();
        commands_.push_back({now, {std::abs(left), std::abs(right)}});
    }
    void look(double now) {
        for (std::size_t i = 0; i < 2; ++i) {
            const double speed = speed_of(rig_.chip(), kControl[i], kPeriodRegister[i]);
            const double steps = rig_.get(kWheel[i]) - std::exchange(position_[i], rig_.get(kWheel[i]));
            const bool backward = steps * signs_[i] < 0;
            bool meant = speed == 0;
            for (const Command& command : commands_)
                meant = meant || std::abs(speed - command.speeds[i]) <= kSameSpeed * command.speeds[i];
            if (meant && !backward) garbage_since_[i] = now;
            garbage = std::max(garbage, now - garbage_since_[i]);
            if (speed == 0 || commands_.empty()) continue;
            stale = std::max(stale, now - commands_.back().time - kPeriod - kHandling);
        }
    }
    void forget(double now) { garbage_since_ = {now, now}; }
    bool at_rest() { return speed(0) == 0 && speed(1) == 0; }

    double garbage = 0, stale = 0;

  private:
    static constexpr std::array kWheel{"wheel_left", "wheel_right"};
    static constexpr std::array kControl{"T5CON", "T4CON"};
    static constexpr std::array kPeriodRegister{"PR5", "PR4"};
    struct Command {
        double time;
        std::array<int, 2> speeds;
    };
    double speed(std::size_t i) { return speed_of(rig_.chip(), kControl[i], kPeriodRegister[i]); }

    exec::Rig& rig_;
    std::array<double, 2> signs_, position_{};
    std::array<double, 2> garbage_since_{};
    std::deque<Command> commands_;
};

class FaultyLine : public control::Transport {
  public:
    FaultyLine(exec::Rig& rig, Watch& watch, const RecordFault& fault)
        : rig_(rig), watch_(watch), fault_(fault) {
        rig_.take_bytes(2);
        watch_.forget(now());
    }
    double now() override { return rig_.now_s() + kRounding; }
    void sleep_until(double time) override {
        while (time - rig_.now_s() > kRounding) {
            rig_.run_to(std::min(time, rig_.now_s() + kGrain));
            watch_.look(now());
        }
    }
    std::size_t read(std::span<std::uint8_t> into, double until) override {
        collect();
        while (received_.empty() && until - rig_.now_s() > kRounding) {
            sleep_until(std::min(until, rig_.now_s() + kGrain));
            collect();
        }
        const std::size_t count = std::min(into.size(), received_.size());
        std::copy_n(received_.begin(), count, into.begin());
        received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(count));
        return count;
    }
    void write(std::span<const std::uint8_t> bytes) override {
        // All but a record's last byte go out together: the program means these speeds from now on.
        if (bytes.size() == protocols::kEpuckActuatorBytes - 1)
            watch_.commanded(now(), static_cast<std::int16_t>(bytes[0] | bytes[1] << 8),
                             static_cast<std::int16_t>(bytes[2] | bytes[3] << 8));
        std::vector<std::uint8_t> arriving;
        for (const std::uint8_t byte : bytes)
            pass(byte, true, sent_++, arriving);
        if (!arriving.empty()) rig_.send(2, arriving);
    }

    double fired_at = -1;

  private:
    template <class Bytes>
    void pass(std::uint8_t byte, bool to_pic, unsigned long ordinal, Bytes& out) {
        const bool hit = to_pic == fault_.to_pic && ordinal == fault_.byte;
        if (hit) fired_at = now();
        if (hit && fault_.kind == ByteFault::Flipped)
            byte = static_cast<std::uint8_t>(byte ^ 1u << fault_.bit);
        if (!hit || fault_.kind != ByteFault::Lost) out.push_back(byte);
        if (hit && fault_.kind == ByteFault::Doubled) out.push_back(byte);
    }
    void collect() {
        for (const std::uint8_t byte : rig_.take_bytes(2))
            pass(byte, false, heard_++, received_);
    }

    exec::Rig& rig_;
    Watch& watch_;
    RecordFault fault_;
    unsigned long sent_ = 0, heard_ = 0;
    std::deque<std::uint8_t> received_;
};

}  // namespace

std::string RecordFault::text() const {
    const char* const names[] = {"lost", "doubled", "flipped"};
    return fmt::format("byte {} {} the PIC {} (bit {})", byte, to_pic ? "to" : "from",
                       names[static_cast<int>(kind)], bit);
}

RecordBench::RecordBench(const std::string& image, double ready) : rig_("pic", image) {
    rig_.run_to(ready);
}

RecordRun RecordBench::run(const RecordFault& fault, std::uint64_t seed, int steps, int exchanges) {
    RecordRun out;
    Drawn behaviour(seed);
    Watch watch(rig_, behaviour.signs());
    control::LoopSettings settings;
    settings.period = kPeriod;
    settings.duration = steps * kPeriod;
    settings.exchanges = exchanges;
    settings.give_up = settings.start_wait = 5;
    {
        FaultyLine line(rig_, watch, fault);
        control::Session session{line, [](const std::string&) {}, [] { return false; }};
        double last_good = 0;
        bool recovered = false;
        // Asked at every step and try: when did the first good record after the fault come?
        const auto note = [&] {
            if (!recovered && line.fired_at >= 0 && session.newest() &&
                session.newest_time() > line.fired_at) {
                recovered = true;
                out.recovery = session.newest_time() - line.fired_at;
            }
            last_good = session.newest_time();
            return false;
        };
        out.reached = run_control_loop(session, line, behaviour, {}, note, settings);
        note();
        out.fired = line.fired_at >= 0;
        out.counters = session.counters();
        out.seen_wrong = behaviour.seen_wrong();
        // The end record has no answer: nothing is to be recovered after it.
        if (out.fired && !recovered) out.recovery = line.now() - line.fired_at;
        line.sleep_until(line.now() + 0.5);
        out.came_to_rest = watch.at_rest();
    }
    FaultyLine line(rig_, watch, {true, ~0ul});
    control::Session again{line, [](const std::string&) {}, [] { return false; }};
    const double begun = line.now();
    out.next_session = again.start(begun + 1) && line.now() - begun < 3 * kPeriod;
    again.end();
    line.sleep_until(line.now() + 0.05);
    out.garbage = watch.garbage;
    out.stale = watch.stale;
    return out;
}

}  // namespace puckloop::framing
