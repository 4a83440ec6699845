#include "emu/chip/faults/board_faults.h"

#include "base/error.h"

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

// A drift is a staircase: the clock's rate changes so often.
constexpr Time kDriftStep = 10 * cosim::kMillisecond;
constexpr double kMostPpm = 90'000.0;
constexpr std::array<std::string_view, 12> kKinds{
    "reset",      "hang",        "brown_out",       "flip",         "interrupt",    "clock", "sag",
    "phase_open", "wheel_stall", "foreign_carrier", "emitter_dead", "receiver_dead"};

[[noreturn]] void refuse(const FaultSpec& spec, const std::string& what, const std::string& expected) {
    throw InputError("", fmt::format("fault {} on {}", spec.name, spec.node), what, expected);
}

int motor_of(const FaultSpec& spec) {
    return spec.parameters.text("motor") == "right" ? 1 : 0;
}

/// A number as the firmware's listing has it: decimal or 0x.
std::optional<std::uint32_t> number_of(const std::string& text) {
    try {
        std::size_t end = 0;
        const unsigned long value = std::stoul(text, &end, 0);
        if (end == text.size() && text[0] != '-' && value <= 0xFFFFFF)
            return static_cast<std::uint32_t>(value);
    } catch (const std::exception&) {
    }
    return std::nullopt;
}

}  // namespace

BoardFaults::BoardFaults(std::vector<CarriedFault> faults, ChipAccess& chip, BoardAccess& board,
                         const Symbols& symbols, double ppm, Time origin)
    : faults_(std::move(faults)), chip_(chip), board_(board), ppm_(ppm), origin_(origin) {
    for (const CarriedFault& fault : faults_) {
        plans_.push_back(plan_of(fault, symbols));
        changes_clock_ |= plans_.back().kind == Kind::Clock;
        shines_ |= plans_.back().kind == Kind::ForeignCarrier;
        sags_ |= plans_.back().kind == Kind::Sag;
        harms_motors_ |= plans_.back().kind == Kind::PhaseOpen || plans_.back().kind == Kind::WheelStall;
    }
    for (std::size_t i = 0; i < plans_.size(); ++i)
        plan_next(i, 0);
    settle_next();
    watch();
}

BoardFaults::Plan BoardFaults::plan_of(const CarriedFault& fault, const Symbols& symbols) const {
    const FaultSpec& spec = fault.spec;
    const auto found = std::find(kKinds.begin(), kKinds.end(), spec.kind);
    if (found == kKinds.end()) refuse(spec, fmt::format("a board knows no {}", spec.kind), "another kind");
    Plan plan;
    plan.kind = static_cast<Kind>(found - kKinds.begin());
    plan.holds = plan.kind >= Kind::Clock && plan.kind <= Kind::ForeignCarrier;
    if (const std::string pc = spec.parameters.text("pc"); !pc.empty()) {
        std::optional<std::uint32_t> address = symbols.code(pc);
        if (!address) address = number_of(pc);
        if (!address || chip_.bits({MemorySpace::Flash, *address}) == 0)
            refuse(spec, fmt::format("no program at pc = '{}'", pc),
                   "a function of the firmware, if its file has symbols, or an even address");
        plan.by_pc = true;
        plan.pc = *address;
    }
    if (plan.kind == Kind::Reset) {
        plan.cause = reset_cause_of_name(spec.parameters.text("cause", "mclr")).value_or(plan.cause);
        if (!chip_.knows(plan.cause))
            refuse(spec, fmt::format("this chip has no reset by {}", spec.parameters.text("cause")),
                   "power_on, brown_out, mclr or watchdog");
    }
    if (plan.kind == Kind::Interrupt) {
        const std::string source = spec.parameters.text("vector");
        const std::optional<int> vector = chip_.vector(source);
        if (!vector)
            refuse(spec, fmt::format("no interrupt source '{}' that a fault can raise", source),
                   "a name of the data sheet's vector table of a dsPIC, as U2RX or T1");
        plan.vector = *vector;
    }
    if (plan.kind == Kind::Flip) plan_flip(plan, fault, symbols);
    return plan;
}

void BoardFaults::plan_flip(Plan& plan, const CarriedFault& fault, const Symbols& symbols) const {
    const FaultSpec& spec = fault.spec;
    plan.space = memory_space_of_name(spec.parameters.text("space", "ram")).value_or(MemorySpace::Ram);
    if (chip_.cells(plan.space) == 0) refuse(spec, "this chip has no such memory", "another space");
    const std::string symbol = spec.parameters.text("symbol");
    std::optional<std::uint32_t> address;
    if (spec.parameters.has("address"))
        address = static_cast<std::uint32_t>(spec.parameters.number("address"));
    if (!symbol.empty()) {
        if (plan.space == MemorySpace::Register) {
            plan.place = chip_.find_register(symbol);
            if (!plan.place)
                refuse(spec, fmt::format("no register '{}' that is modelled", symbol), "a data-sheet name");
        } else {
            const auto base = (plan.space == MemorySpace::Flash ? symbols.code : symbols.data)(symbol);
            if (!base)
                refuse(spec, fmt::format("no symbol '{}'", symbol),
                       "a name of the firmware's, if its file has symbols");
            address = *base + address.value_or(0);
        }
    }
    if (!plan.place && address) plan.place = MemoryPlace{plan.space, *address};
    if (plan.place && chip_.bits(*plan.place) == 0)
        refuse(spec,
               fmt::format("no cell of the {} at 0x{:X}", spec.parameters.text("space", "ram"),
                           plan.place->address),
               "an address that the chip has");
    if (!spec.parameters.has("bit")) return;
    plan.bit = static_cast<int>(spec.parameters.number("bit"));
    const std::uint32_t bits = plan.place ? chip_.bits(*plan.place) : chip_.bits(chip_.cell(plan.space, 0));
    if ((plan.place || plan.space != MemorySpace::Register) && !(bits >> plan.bit & 1))
        refuse(spec, fmt::format("no bit {} there", plan.bit), fmt::format("one of the bits 0x{:X}", bits));
}

void BoardFaults::plan_next(std::size_t i, Time from) {
    const CarriedFault& fault = faults_[i];
    Plan& plan = plans_[i];
    const cosim::Trigger& trigger = fault.trigger;
    if (!plan.holds) {
        const bool by_burst = plan.kind == Kind::EmitterDead || plan.kind == Kind::ReceiverDead;
        plan.due = plan.by_pc || by_burst || trigger.spent() ? kNever : trigger.instant(from);
        return;
    }
    if (from <= trigger.begin())
        plan.due = trigger.begin();
    else if (trigger.end() < from)
        plan.due = kNever;
    else
        plan.due = trigger.end();
    if (plan.kind == Kind::Clock && fault.spec.parameters.number("drift") != 0.0 && from > trigger.begin() &&
        trigger.open(from)) {
        const Time steps = (from - trigger.begin() + kDriftStep - 1) / kDriftStep;
        plan.due = std::min(plan.due, cosim::later(trigger.begin(), steps * kDriftStep));
    }
}

void BoardFaults::settle_next() {
    next_ = kNever;
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
    bool holds = false;
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
        chip_.interrupt(plans_[i].vector);
        break;
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
    for (std::size_t i = 0; i < plans_.size(); ++i) {
        CarriedFault& fault = faults_[i];
        const FaultSpec& spec = fault.spec;
        if (!plans_[i].holds || !fault.trigger.open(now)) continue;
        const auto motor = static_cast<std::size_t>(motor_of(spec));
        std::string what;
        switch (plans_[i].kind) {
        case Kind::Clock: {
            const double more =
                spec.parameters.number("ppm") +
                spec.parameters.number("drift") * cosim::to_seconds(now - fault.trigger.begin());
            ppm += more;
            what = fmt::format("{:g} ppm", more);
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
    if (changes_clock_) chip_.set_ppm(std::clamp(ppm, -kMostPpm, kMostPpm));
    if (sags_) board_.set_sag(volts);
    if (shines_) board_.set_carrier(lit);
    if (harms_motors_)
        for (std::size_t motor = 0; motor < 2; ++motor)
            board_.set_motor(static_cast<int>(motor), open[motor], stalled[motor]);
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

void BoardFaults::loaded(Time now) {
    for (std::size_t i = 0; i < plans_.size(); ++i)
        plan_next(i, plans_[i].holds ? now + 1 : now);
    settle_next();
    stops_.clear();
    watch();
    hold(now);
}

}  // namespace puckloop::chip
