#include "emu/chip/faults/board_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

namespace puckloop::chip {

namespace {

using cosim::CarriedFault;
using cosim::FaultSpec;
using cosim::kNever;
using cosim::Time;

// A drift or a profile is a staircase: rate or voltage change so often.
constexpr Time kStep = 10 * cosim::kMillisecond;
constexpr double kMostPpm = 90'000.0, kMostVolts = 10.0;

std::vector<cosim::ProfilePoint> profile_of(const FaultSpec& spec) {
    return cosim::voltage_profile(spec.parameters.text("profile"), kMostVolts);
}

int motor_of(const FaultSpec& spec) {
    return spec.parameters.text("motor") == "right" ? 1 : 0;
}

/// When the step of a battery's staircase began that holds `since` the fault's begin: at a whole kStep or at
/// a point. A state may be loaded, or another fault begin, in the middle of a step.
Time begin_of_step(const std::vector<cosim::ProfilePoint>& points, Time since) {
    Time step = since - since % kStep;
    for (const cosim::ProfilePoint& point : points)
        if (point.time <= since) step = std::max(step, point.time);
    return step;
}

}  // namespace

BoardFaults::BoardFaults(std::vector<CarriedFault> faults, ChipAccess& chip, BoardAccess& board,
                         const Symbols& symbols, double ppm, Time origin)
    : faults_(std::move(faults)), chip_(chip), board_(board), ppm_(ppm), origin_(origin) {
    for (const CarriedFault& fault : faults_) {
        plans_.push_back(plan_of(fault, symbols));
        if (plans_.back().kind == Kind::Clock) clock_from_ = std::min(clock_from_, fault.trigger.begin());
        shines_ |= plans_.back().kind == Kind::ForeignCarrier;
        sags_ |= plans_.back().kind == Kind::Sag;
        drains_ |= plans_.back().kind == Kind::Battery;
        dazzles_ |= plans_.back().kind == Kind::AmbientBurst;
        profiles_.push_back(plans_.back().kind == Kind::Battery ? profile_of(fault.spec)
                                                                : std::vector<cosim::ProfilePoint>{});
        harms_motors_ |= plans_.back().kind == Kind::PhaseOpen || plans_.back().kind == Kind::WheelStall;
    }
    for (std::size_t i = 0; i < plans_.size(); ++i)
        plan_next(i, 0);
    settle_next();
    watch();
    watch_interrupts();
}

void BoardFaults::plan_next(std::size_t i, Time from) {
    const CarriedFault& fault = faults_[i];
    Plan& plan = plans_[i];
    const cosim::Trigger& trigger = fault.trigger;
    if (!plan.holds) {
        const bool comes = plan.by_pc || plan.candidates;
        plan.due = comes || trigger.spent() ? kNever : trigger.instant(from);
        return;
    }
    if (from <= trigger.begin())
        plan.due = trigger.begin();
    else if (trigger.end() < from)
        plan.due = kNever;
    else
        plan.due = trigger.end();
    if (from > trigger.begin() && trigger.open(from)) plan.due = std::min(plan.due, next_step(i, from));
}

/// Of a staircase, at or after `from`.
Time BoardFaults::next_step(std::size_t i, Time from) const {
    const Time begin = faults_[i].trigger.begin();
    const Time step = cosim::later(begin, (from - begin + kStep - 1) / kStep * kStep);
    if (plans_[i].kind == Kind::Clock)
        return faults_[i].spec.parameters.number("drift") != 0.0 ? step : kNever;
    if (plans_[i].kind != Kind::Battery || from - begin > profiles_[i].back().time) return kNever;
    const auto point = std::find_if(profiles_[i].begin(), profiles_[i].end(),
                                    [&](const cosim::ProfilePoint& one) { return begin + one.time >= from; });
    return std::min(step, begin + point->time);
}

void BoardFaults::settle_next() {
    next_ = holds_anew_;
    for (const Plan& plan : plans_)
        next_ = std::min(next_, plan.due);
}

/// Without a count, once: a reset at each arrival would be another fault.
bool BoardFaults::spent_at_pc(std::size_t i) const {
    constexpr std::uint64_t kNoCount = ~0ull;
    const cosim::Trigger& trigger = faults_[i].trigger;
    return trigger.spent() || (faults_[i].spec.count == kNoCount && trigger.fired() > 0);
}

/// Stop addresses of the faults that may still fire.
void BoardFaults::watch() {
    std::vector<std::uint32_t> wanted;
    for (std::size_t i = 0; i < plans_.size(); ++i)
        if (plans_[i].by_pc && !spent_at_pc(i)) wanted.push_back(plans_[i].pc);
    if (wanted == stops_) return;
    stops_ = std::move(wanted);
    chip_.set_stops(stops_);
}

void BoardFaults::act(Time now) {
    bool holds = holds_anew_ <= now;
    if (holds) holds_anew_ = kNever;
    for (std::size_t i = 0; i < plans_.size(); ++i) {
        if (plans_[i].due > now) continue;
        plan_next(i, now + 1);
        if (plans_[i].holds)
            holds = true;
        else if (live(now) && faults_[i].trigger.fires(now))
            fire(i, now);
    }
    settle_next();
    if (holds) hold(now);
}

void BoardFaults::arrived(Time now) {
    const std::uint32_t pc = chip_.pc();
    for (std::size_t i = 0; i < plans_.size(); ++i) {
        Plan& plan = plans_[i];
        cosim::Trigger& trigger = faults_[i].trigger;
        if (!plan.by_pc || plan.pc != pc || !trigger.open(now)) continue;
        ++plan.arrivals;
        if (static_cast<double>(plan.arrivals) < faults_[i].spec.parameters.number("nth", 1.0)) continue;
        if (!spent_at_pc(i) && trigger.fires(now)) fire(i, now);
    }
    watch();
}

void BoardFaults::fire(std::size_t i, Time now) {
    const FaultSpec& spec = faults_[i].spec;
    const std::uint32_t pc = chip_.pc();
    const Time duration = spec.parameters.time("duration", kNever);
    const Time end = duration == kNever ? kNever : cosim::later(now, duration) - origin_;
    std::string what;
    switch (plans_[i].kind) {
    case Kind::Reset:
        what = spec.parameters.text("cause", "mclr");
        chip_.reset(plans_[i].cause);
        break;
    case Kind::Hang:
        chip_.hang(end);
        break;
    case Kind::BrownOut:
        chip_.reset(FaultReset::BrownOut);
        chip_.hang(end);
        break;
    case Kind::Flip:
        what = flip(i);
        break;
    case Kind::Interrupt:
        what = spec.parameters.text("vector");
        if (!chip_.interrupt(plans_[i].vector)) return;  // nothing happened: no evidence
        break;
    case Kind::Flash: {
        const std::string file = spec.parameters.text("image");
        what = file.substr(file.rfind('/') + 1);
        chip_.program(file);
        chip_.reset(FaultReset::External);
        break;
    }
    default:
        break;
    }
    faults_[i].fired(now, pc, fmt::format("{}{}pc 0x{:X}", what, what.empty() ? "" : " at ", pc));
}

std::string BoardFaults::flip(std::size_t i) {
    const Plan& plan = plans_[i];
    RandomStream& random = faults_[i].trigger.random();
    const MemoryPlace place =
        plan.place
            ? *plan.place
            : chip_.cell(plan.space, static_cast<std::uint32_t>(random.below(chip_.cells(plan.space))));
    const std::uint32_t bits = chip_.bits(place);
    int bit = plan.bit;
    if (bit < 0 || !(bits >> bit & 1)) {
        std::uint32_t left = bits;
        for (std::uint64_t skip = random.below(static_cast<std::uint64_t>(std::popcount(bits))); skip > 0;
             --skip)
            left &= left - 1;
        bit = std::countr_zero(left);
    }
    const std::uint32_t before = chip_.read(place);
    chip_.flip(place, 1u << bit);
    const std::string_view name = chip_.name(place);
    return fmt::format("{} bit {} 0x{:X} to 0x{:X}",
                       name.empty() ? fmt::format("{} 0x{:X}",
                                                  memory_space_names()[static_cast<std::size_t>(place.space)],
                                                  place.address)
                                    : std::string(name),
                       bit, before, chip_.read(place));
}

/// Everything that holds at `now`, together.
void BoardFaults::hold(Time now) {
    double ppm = ppm_, volts = 0.0;
    std::array<std::uint8_t, 2> open{};
    std::array<bool, 2> stalled{};
    std::uint16_t lit = 0;
    std::optional<double> supply;
    AmbientShares ambient{};
    for (std::size_t i = 0; i < plans_.size(); ++i) {
        CarriedFault& fault = faults_[i];
        const FaultSpec& spec = fault.spec;
        if (!plans_[i].holds || !fault.trigger.open(now)) continue;
        const auto motor = static_cast<std::size_t>(motor_of(spec));
        std::string what;
        switch (plans_[i].kind) {
        case Kind::Clock: {
            // The rate in the step's middle: at its end the phase is the drift's own.
            const Time since = now - fault.trigger.begin();
            const Time step = since - since % kStep;
            const Time end = std::min(step + kStep, fault.trigger.end() - fault.trigger.begin());
            const double seconds = (cosim::to_seconds(step) + cosim::to_seconds(end)) / 2;
            const double offset = spec.parameters.number("ppm"), drift = spec.parameters.number("drift");
            ppm += offset + (drift == 0.0 ? 0.0 : drift * seconds);
            what = fmt::format("{:g} ppm", offset);
            break;
        }
        case Kind::Battery:
            supply = cosim::value_at(profiles_[i], begin_of_step(profiles_[i], now - fault.trigger.begin()));
            show_profile(i, now);
            continue;
        case Kind::AmbientBurst: {
            const auto sensor = static_cast<std::size_t>(spec.parameters.number("sensor"));
            const double share = spec.parameters.number("strength", 1.0);
            for (std::size_t k = 0; k < ambient.size(); ++k)
                if (sensor == 0 || sensor == k + 1) ambient[k] = std::max(ambient[k], share);
            what = sensor == 0 ? "all sensors" : fmt::format("sensor {}", sensor);
            break;
        }
        case Kind::Sag:
            volts += spec.parameters.number("volts");
            what = fmt::format("{:g} V", spec.parameters.number("volts"));
            break;
        case Kind::PhaseOpen:
            open[motor] =
                static_cast<std::uint8_t>(open[motor] | (spec.parameters.number("winding", 1) == 2 ? 2 : 1));
            continue;  // evidence: lost_step()
        case Kind::ForeignCarrier: {
            const int receiver = static_cast<int>(spec.parameters.number("receiver"));
            lit = static_cast<std::uint16_t>(lit | (receiver == 0 ? 0xFFF : 1 << (receiver - 1)));
            what = receiver == 0 ? "all receivers" : fmt::format("receiver {}", receiver);
            break;
        }
        default:
            stalled[motor] = true;
            continue;
        }
        if (fault.trigger.fired() == 0 && live(now) && fault.trigger.fires(now)) fault.fired(now, 0, what);
    }
    if (clock_from_ != kNever) chip_.set_ppm(std::clamp(ppm, -kMostPpm, kMostPpm));
    if (drains_) board_.set_battery(supply);
    if (sags_) board_.set_sag(volts);
    if (dazzles_) board_.set_ambient(ambient);
    if (shines_) board_.set_carrier(lit);
    if (harms_motors_)
        for (std::size_t motor = 0; motor < 2; ++motor)
            board_.set_motor(static_cast<int>(motor), open[motor], stalled[motor]);
}

/// The points that have been reached, each once.
void BoardFaults::show_profile(std::size_t i, Time now) {
    CarriedFault& fault = faults_[i];
    const auto& points = profiles_[i];
    const auto reached = std::count_if(points.begin(), points.end(), [&](const cosim::ProfilePoint& point) {
        return fault.trigger.begin() + point.time <= now;
    });
    const auto wanted = static_cast<std::uint64_t>(std::max<std::ptrdiff_t>(reached, 1));
    while (fault.trigger.fired() < wanted && live(now) && fault.trigger.fires(now))
        fault.fired(now, fault.trigger.fired() - 1,
                    fmt::format("{:g} V", cosim::value_at(points, now - fault.trigger.begin())));
}

void BoardFaults::lost_step(int motor, Time now) {
    for (std::size_t i = 0; i < plans_.size(); ++i) {
        const bool harms = plans_[i].kind == Kind::PhaseOpen || plans_[i].kind == Kind::WheelStall;
        CarriedFault& fault = faults_[i];
        if (harms && motor_of(fault.spec) == motor && fault.trigger.fires(now))
            fault.fired(now, fault.trigger.fired() - 1, motor == 0 ? "left step" : "right step");
    }
}

bool BoardFaults::loses_burst(bool emitter, int number, Time now) {
    bool lost = false;
    for (std::size_t i = 0; i < plans_.size(); ++i) {
        Plan& plan = plans_[i];
        CarriedFault& fault = faults_[i];
        if (plan.kind != (emitter ? Kind::EmitterDead : Kind::ReceiverDead)) continue;
        const double wanted = fault.spec.parameters.number(emitter ? "emitter" : "receiver");
        if (wanted != 0 && wanted != number) continue;
        if (plan.burst != now) {
            plan.burst = now;
            plan.burst_lost = fault.trigger.fires(now);
            if (plan.burst_lost)
                fault.fired(now, fault.trigger.fired() - 1,
                            fmt::format("{} {}", emitter ? "emitter" : "receiver", number));
        }
        lost |= plan.burst_lost;
    }
    return lost;
}

void BoardFaults::watch_interrupts() {
    std::vector<int> vectors;
    for (const Plan& plan : plans_)
        if (plan.kind == Kind::LostInterrupt || plan.kind == Kind::LateInterrupt)
            vectors.push_back(plan.vector);
    if (vectors.empty()) return;
    chip_.watch_interrupts(vectors, [this](int vector, Time now) { return interrupt_time(vector, now); });
}

/// Of an interrupt at `now` of the chip's time; every fault of its source looks at it.
Time BoardFaults::interrupt_time(int vector, Time now) {
    const Time time = cosim::later(now, origin_);
    Time when = now;
    for (std::size_t i = 0; i < plans_.size(); ++i) {
        Plan& plan = plans_[i];
        const bool late = plan.kind == Kind::LateInterrupt;
        if (plan.vector != vector || (!late && plan.kind != Kind::LostInterrupt)) continue;
        CarriedFault& fault = faults_[i];
        const std::uint64_t number = plan.arrivals++;
        if (!fault.trigger.fires(time)) continue;
        const cosim::FaultParameters& parameters = fault.spec.parameters;
        if (!late) {
            when = kNever;
            fault.fired(time, number, parameters.text("vector") + " lost");
            continue;
        }
        const double jitter = parameters.number("jitter");
        const double seconds = parameters.number("delay") +
                               (jitter > 0 ? jitter * (2 * fault.trigger.random().uniform() - 1) : 0.0);
        const Time delay = std::max<Time>(cosim::from_seconds(std::max(seconds, 0.0)), 1);
        when = std::max(when, cosim::later(now, delay));
        fault.fired(time, number,
                    fmt::format("{} late by {:g} s", parameters.text("vector"), cosim::to_seconds(delay)));
    }
    return when;
}

/// By the image that was programmed last.
void BoardFaults::name_places() const {
    const CarriedFault* latest = nullptr;
    for (std::size_t i = 0; i < plans_.size(); ++i) {
        const cosim::Trigger& trigger = faults_[i].trigger;
        if (plans_[i].kind != Kind::Flash || trigger.fired() == 0) continue;
        if (latest == nullptr || trigger.begin() >= latest->trigger.begin()) latest = &faults_[i];
    }
    if (latest != nullptr) chip_.name_places(latest->spec.parameters.text("image"));
}

void BoardFaults::loaded(Time now, bool others) {
    name_places();
    if (others) sags_ = drains_ = dazzles_ = shines_ = harms_motors_ = true;
    for (std::size_t i = 0; i < plans_.size(); ++i)
        plan_next(i, plans_[i].holds ? now + 1 : now);
    holds_anew_ = now;
    settle_next();
    stops_.clear();
    watch();
}

}  // namespace puckloop::chip
