#include "cosim/can/can_faults.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::cosim {

std::string can_text(const protocols::CanFrame& frame) {
    const std::string id = frame.extended ? fmt::format("{:08x}", frame.id) : fmt::format("{:03x}", frame.id);
    return frame.remote ? fmt::format("{} remote", id) : fmt::format("{} [{}]", id, frame.length);
}

CanFaults::CanFaults(std::vector<CarriedFault> faults, std::vector<std::string> controllers)
    : carried_(std::move(faults)), controllers_(std::move(controllers)) {
    const auto place = [this](const CarriedFault& fault, const std::string& name) {
        std::optional<std::size_t> index;
        if (name.empty()) return index;
        const auto found = std::find(controllers_.begin(), controllers_.end(), name);
        if (found == controllers_.end())
            throw InputError("", "fault " + fault.spec.name,
                             fmt::format("no controller '{}' on the bus", name),
                             fmt::format("one of {}", fmt::join(controllers_, ", ")));
        index = static_cast<std::size_t>(found - controllers_.begin());
        return index;
    };
    for (const CarriedFault& carried : carried_) {
        const FaultSpec& spec = carried.spec;
        Fault fault;
        if (spec.kind == "drop") fault.kind = Kind::Drop;
        if (spec.kind == "disconnect") fault.kind = Kind::Disconnect;
        if (spec.kind == "stuck")
            fault.kind = spec.parameters.text("level") == "recessive" ? Kind::Recessive : Kind::Dominant;
        fault.from = place(carried, spec.from);
        fault.to = place(carried, spec.parameters.text("to"));
        if (spec.parameters.has("id")) fault.id = static_cast<std::uint32_t>(spec.parameters.number("id"));
        faults_.push_back(fault);
    }
}

Time CanFaults::next_change(Time time) const {
    Time next = kNever;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        if (faults_[i].kind == Kind::Flip || faults_[i].kind == Kind::Drop) continue;
        for (const Time change : {carried_[i].trigger.begin(), carried_[i].trigger.end()})
            if (change > time) next = std::min(next, change);
    }
    return next;
}

bool CanFaults::holds(Kind kind, Time now) const {
    for (std::size_t i = 0; i < faults_.size(); ++i)
        if (faults_[i].kind == kind && carried_[i].trigger.open(now)) return true;
    return false;
}

bool CanFaults::cut_off(std::size_t controller, Time now) const {
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        const Fault& fault = faults_[i];
        const bool cuts = fault.kind == Kind::Recessive ||
                          (fault.kind == Kind::Disconnect && (!fault.from || *fault.from == controller));
        if (cuts && carried_[i].trigger.open(now)) return true;
    }
    return false;
}

/// A window counts once, with the first controller that feels it.
void CanFaults::felt(std::size_t index, Time now, const std::string& what) {
    Fault& fault = faults_[index];
    const Time begin = carried_[index].trigger.begin();
    if (fault.felt == begin || !carried_[index].trigger.fires(now)) return;
    fault.felt = begin;
    carried_[index].fired(now, frames_, what);
}

void CanFaults::felt_dominant(Time now, std::size_t controller) {
    for (std::size_t i = 0; i < faults_.size(); ++i)
        if (faults_[i].kind == Kind::Dominant && carried_[i].trigger.open(now))
            felt(i, now, controllers_[controller] + " reads dominant");
}

void CanFaults::felt_cut(Time now, std::size_t controller) {
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        const Fault& fault = faults_[i];
        const bool cuts = fault.kind == Kind::Recessive ||
                          (fault.kind == Kind::Disconnect && (!fault.from || *fault.from == controller));
        if (cuts && carried_[i].trigger.open(now)) felt(i, now, controllers_[controller] + " is alone");
    }
}

void CanFaults::conclude(Time now) {
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        const Time begin = carried_[i].trigger.begin();
        if (faults_[i].kind == Kind::Dominant && begin < now)
            felt(i, begin, "the wire is dominant and no controller takes part");
    }
}

bool CanFaults::meant(const Fault& fault, std::size_t sender, const protocols::CanFrame& frame) const {
    return (!fault.from || *fault.from == sender) && (!fault.id || *fault.id == frame.id);
}

std::vector<CanFlip> CanFaults::strike(std::size_t sender, const protocols::CanFrame& frame,
                                       const protocols::CanBits& bits, Time start) {
    ++frames_;
    std::vector<CanFlip> flips;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        const Fault& fault = faults_[i];
        if (fault.kind != Kind::Flip || !meant(fault, sender, frame)) continue;
        if (!carried_[i].trigger.fires(start)) continue;
        const int first = bits.arbitration + 1;
        const int count = bits.count - first;
        const FaultParameters& given = carried_[i].spec.parameters;
        const int drawn =
            given.has("bit")
                ? static_cast<int>(given.number("bit"))
                : static_cast<int>(carried_[i].trigger.random().below(static_cast<std::uint64_t>(count)));
        const int bit = first + std::min(drawn, count - 1);
        flips.push_back({bit, fault.to});
        carried_[i].fired(start, frames_ - 1,
                          fmt::format("{} from {} bit {}{}", can_text(frame), controllers_[sender], bit,
                                      fault.to ? " at " + controllers_[*fault.to] : ""));
    }
    return flips;
}

bool CanFaults::drops(std::size_t sender, std::size_t receiver, const protocols::CanFrame& frame,
                      Time start) {
    bool dropped = false;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        const Fault& fault = faults_[i];
        if (fault.kind != Kind::Drop || !meant(fault, sender, frame)) continue;
        if ((fault.to && *fault.to != receiver) || !carried_[i].trigger.fires(start)) continue;
        dropped = true;
        carried_[i].fired(
            start, frames_,
            fmt::format("{} from {} to {}", can_text(frame), controllers_[sender], controllers_[receiver]));
    }
    return dropped;
}

}  // namespace puckloop::cosim
