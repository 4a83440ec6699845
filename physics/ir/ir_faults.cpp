#include "physics/ir/ir_faults.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace puckloop::physics {

using cosim::CarriedFault;
using cosim::FaultSpec;
using cosim::kNever;
using cosim::Time;

namespace {

constexpr std::uint16_t kAllParts = (1U << kIrSensors) - 1;
constexpr double kRadians = std::numbers::pi / 180;
constexpr std::array<std::string_view, 6> kKinds{"weak_emitter",  "weak_receiver", "occlusion",
                                                 "ambient_burst", "chip_flip",     "chip_jitter"};

[[noreturn]] void refuse(const FaultSpec& spec, const std::string& what, const std::string& expected) {
    throw InputError("", fmt::format("fault {} on {}", spec.name, spec.link), what, expected);
}

}  // namespace

IrFaults::IrFaults(std::vector<CarriedFault> faults, const IrMedium& medium)
    : faults_(std::move(faults)),
      medium_(medium),
      boards_(medium.board_count()),
      flips_(boards_),
      frames_(boards_),
      hits_(boards_ * boards_ * faults_.size()),
      heard_(boards_ * boards_),
      tracks_(boards_),
      seen_(boards_ * boards_),
      on_(faults_.size()),
      again_(boards_),
      shone_(boards_) {
    for (std::size_t s = 0; s < boards_; ++s)
        chip_.push_back(cosim::from_seconds(medium.parameters(s).chip));
    for (const CarriedFault& fault : faults_) {
        const Plan plan = plan_of(fault.spec);
        plans_.push_back(plan);
        chips_ |= plan.kind == Kind::Flip || plan.kind == Kind::Jitter;
        for (std::size_t s = 0; plan.kind == Kind::Flip && s < boards_; ++s)
            if (s == plan.board ? plan.sent : plan.arriving) flips_[s] = true;
    }
    settle_next(-1);
}

IrFaults::Plan IrFaults::plan_of(const FaultSpec& spec) const {
    const auto* const found = std::find(kKinds.begin(), kKinds.end(), spec.kind);
    if (found == kKinds.end()) refuse(spec, fmt::format("light knows no {}", spec.kind), "another kind");
    const cosim::FaultParameters& p = spec.parameters;
    Plan plan;
    plan.kind = static_cast<Kind>(found - kKinds.begin());
    const std::string_view link = spec.link;
    constexpr std::string_view kEnd = ".ir";
    if (!link.ends_with(kEnd)) refuse(spec, "no way to the infra-red medium", "as robot0.ir");
    plan.board = board_named(spec, link.substr(0, link.size() - kEnd.size()));
    plan.sent = spec.from.empty() || spec.from == medium_.name(plan.board) + ".rab";
    plan.arriving = spec.from.empty() || !plan.sent;
    if (plan.kind == Kind::Emitter) plan.arriving = false;
    if (plan.kind == Kind::Receiver || plan.kind == Kind::Ambient) plan.sent = false;
    if (!plan.sent && !plan.arriving)
        refuse(spec, fmt::format("{} from {}", spec.kind, spec.from), "no 'from'");
    const auto part =
        static_cast<unsigned>(p.number(plan.kind == Kind::Emitter ? "emitter" : "receiver", 0.0));
    plan.parts = part == 0 ? kAllParts : static_cast<std::uint16_t>(1U << (part - 1));
    plan.gain = static_cast<float>(
        p.number("gain", plan.kind == Kind::Occlusion || plan.kind == Kind::Ambient ? 0.0 : 1.0));
    plan.level = static_cast<float>(p.number("level"));
    if (p.has("chip")) plan.chip = static_cast<std::int64_t>(p.number("chip"));
    plan.jitter = p.number("jitter");
    if (const std::string other = p.text("other"); !other.empty()) plan.other = board_named(spec, other);
    plan.sector = p.has("bearing") || p.has("width");
    plan.bearing = p.number("bearing") * kRadians;
    plan.width = p.number("width") * kRadians;
    if (plan.sector && plan.width <= 0.0) refuse(spec, "a sector without width", "width = 1 to 360");
    return plan;
}

std::size_t IrFaults::board_named(const FaultSpec& spec, std::string_view name) const {
    std::string known;
    for (std::size_t board = 0; board < boards_; ++board) {
        if (medium_.name(board) == name) return board;
        known += (board == 0 ? "" : ", ") + medium_.name(board);
    }
    refuse(spec, fmt::format("no range-and-bearing board on '{}'", name), known);
}

/// Does light from the one to the other pass the fault's place?
bool IrFaults::concerns(const Plan& plan, std::size_t sender, std::size_t receiver) const {
    return (plan.sent && sender == plan.board) || (plan.arriving && receiver == plan.board);
}

bool IrFaults::shades(const Plan& plan, std::size_t sender, std::size_t receiver) const {
    const std::size_t other = sender == plan.board ? receiver : sender;
    if (other == plan.board || (plan.other != kAnybody && plan.other != other)) return false;
    if (!plan.sector) return true;
    const double off =
        std::remainder(medium_.bearing(plan.board, other) - plan.bearing, 2 * std::numbers::pi);
    return std::abs(off) <= plan.width / 2;
}

std::string IrFaults::pair(std::size_t sender, std::size_t receiver) const {
    return medium_.name(sender) + " to " + medium_.name(receiver);
}

// ---- frames

void IrFaults::emits(Time now, std::size_t sender, std::uint16_t mask, bool begins) {
    if (begins) begin_frame(now, sender);
    if (chips_) follow(now, sender, mask, begins);
    settle_next(now);
}

void IrFaults::begin_frame(Time now, std::size_t sender) {
    ++frames_[sender];
    const auto row = static_cast<std::ptrdiff_t>(sender * boards_ * faults_.size());
    const auto length = static_cast<std::ptrdiff_t>(boards_ * faults_.size());
    const auto end = hits_.begin() + row + length;
    if (std::find(hits_.begin() + row, end, 1) != end) again_[sender] = 1;
    std::fill(hits_.begin() + row, end, 0);
    bool anybody = false;
    for (std::size_t r = 0; r < boards_; ++r) {
        const auto& carrier = medium_.without_faults(sender, r);
        const auto threshold = static_cast<float>(medium_.parameters(r).threshold);
        const bool heard = std::any_of(carrier.begin(), carrier.end(),
                                       [&](float strength) { return strength >= threshold; });
        heard_[path(sender, r)] = heard ? 1 : 0;
        anybody |= heard && r != sender;
    }
    for (std::size_t f = 0; f < faults_.size(); ++f) {
        const Plan& plan = plans_[f];
        if (plan.kind == Kind::Emitter) {
            if (sender != plan.board || !anybody || !faults_[f].trigger.fires(now)) continue;
            for (std::size_t r = 0; r < boards_; ++r)
                hits_[path(sender, r) * faults_.size() + f] = 1;
            again_[sender] = 1;
            faults_[f].fired(now, frames_[sender] - 1, medium_.name(sender));
        }
        if (plan.kind == Kind::Ambient && on_[f] && heard_[path(sender, plan.board)] && sender != plan.board)
            faults_[f].fired(now, frames_[sender] - 1, pair(sender, plan.board));
        if (plan.kind != Kind::Receiver && plan.kind != Kind::Occlusion) continue;
        for (std::size_t r = 0; r < boards_; ++r)
            if (r != sender && heard_[path(sender, r)] && concerns(plan, sender, r) &&
                (plan.kind == Kind::Receiver || shades(plan, sender, r)))
                hit(f, now, sender, r);
    }
}

void IrFaults::hit(std::size_t fault, Time now, std::size_t sender, std::size_t receiver) {
    if (!faults_[fault].trigger.fires(now)) return;
    hits_[path(sender, receiver) * faults_.size() + fault] = 1;
    again_[sender] = 1;
    faults_[fault].fired(now, frames_[sender] - 1, pair(sender, receiver));
}

bool IrFaults::weakens(std::size_t sender, std::size_t receiver, Factors& factors) const {
    bool any = false;
    for (std::size_t f = 0; f < faults_.size(); ++f) {
        const Plan& plan = plans_[f];
        const bool dazzled = plan.kind == Kind::Ambient && on_[f] && plan.board == receiver;
        if (!dazzled && !was_hit(f, sender, receiver)) continue;
        if (!any) {
            factors.emitter.fill(1.0F);
            factors.carrier.fill(1.0F);
            factors.level.fill(1.0F);
            any = true;
        }
        for (std::size_t k = 0; k < kIrSensors; ++k) {
            if ((plan.parts >> k & 1U) == 0) continue;
            if (plan.kind == Kind::Emitter || plan.kind == Kind::Occlusion) {
                factors.emitter[k] *= plan.gain;
            } else {
                factors.carrier[k] *= plan.gain;
                if (!dazzled) factors.level[k] *= plan.gain;
            }
        }
    }
    return any;
}

void IrFaults::add_ambient(std::size_t board, IrArray<float>& level) const {
    for (std::size_t f = 0; f < faults_.size(); ++f)
        if (plans_[f].kind == Kind::Ambient && on_[f] && plans_[f].board == board)
            for (std::size_t k = 0; k < kIrSensors; ++k)
                if ((plans_[f].parts >> k & 1U) != 0) level[k] += plans_[f].level;
}

bool IrFaults::again(std::size_t sender) {
    return std::exchange(again_[sender], std::uint8_t{0}) != 0;
}
bool IrFaults::shone(std::size_t board) {
    return std::exchange(shone_[board], std::uint8_t{0}) != 0;
}

// ---- instants

void IrFaults::act(Time now) {
    for (std::size_t f = 0; f < faults_.size(); ++f) {
        if (plans_[f].kind != Kind::Ambient) continue;
        const bool open = faults_[f].trigger.open(now);
        if (open == (on_[f] != 0)) continue;
        on_[f] = open ? 1 : 0;
        shone_[plans_[f].board] = 1;
        std::fill(again_.begin(), again_.end(), std::uint8_t{1});
        if (open && faults_[f].trigger.fired() == 0 && faults_[f].trigger.fires(now))
            faults_[f].fired(now, 0, fmt::format("{} dazzled", medium_.name(plans_[f].board)));
    }
    std::size_t come = 0;
    for (; come < late_.size() && late_[come].time <= now; ++come) {
        const Late& edge = late_[come];
        Seen& seen = seen_[path(edge.sender, edge.receiver)];
        seen.mask = edge.mask;
        --seen.late;
        again_[edge.sender] = 1;
    }
    late_.erase(late_.begin(), late_.begin() + static_cast<std::ptrdiff_t>(come));
    for (std::size_t s = 0; s < boards_; ++s)
        if (tracks_[s].next <= now) begin_chip(now, s);
    settle_next(now);
}

void IrFaults::settle_next(Time now) {
    next_ = late_.empty() ? kNever : late_.front().time;
    for (const Track& track : tracks_)
        next_ = std::min(next_, track.next);
    for (std::size_t f = 0; f < faults_.size(); ++f) {
        if (plans_[f].kind != Kind::Ambient) continue;
        const cosim::Trigger& trigger = faults_[f].trigger;
        next_ = std::min(next_, now < trigger.begin() ? trigger.begin()
                                : now < trigger.end() ? trigger.end()
                                                      : kNever);
    }
}

}  // namespace puckloop::physics
