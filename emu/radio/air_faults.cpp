#include "emu/radio/air_faults.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

namespace puckloop::radio {

using cosim::CarriedFault;
using cosim::Time;
using protocols::MeshFrame;

namespace {

/// As in the table of kinds; by protocols::MeshKind.
constexpr std::array<std::string_view, 8> kFrameNames{"data",        "acknowledge",     "route_request",
                                                      "route_reply", "discover",        "discovered",
                                                      "remote_at",   "remote_at_answer"};
constexpr std::string_view kMacAck = "mac_ack";
constexpr std::uint64_t kForeignId = std::uint64_t{1} << 62;  // beyond those of modules' frames
/// A frame is judged when it ends: what ended before the longest began cannot matter.
constexpr Time kForeignMemory = 10 * cosim::kMillisecond;

std::string_view name_of(const MeshFrame* frame) {
    return frame ? kFrameNames.at(static_cast<std::size_t>(frame->kind)) : kMacAck;
}

bool is_clash(const CarriedFault& fault) {
    return fault.spec.kind == "clash";
}

}  // namespace

AirFaults::AirFaults(std::vector<CarriedFault> faults, std::vector<std::string> names)
    : carried_(std::move(faults)), names_(std::move(names)) {
    const auto station = [this](const CarriedFault& fault, const std::string& name) {
        std::optional<std::size_t> place;
        if (name.empty()) return place;
        const auto found = std::find(names_.begin(), names_.end(), name);
        if (found == names_.end())
            throw InputError("", "fault " + fault.spec.name, fmt::format("there is no module of '{}'", name),
                             fmt::format("one of {}", fmt::join(names_, ", ")));
        place = static_cast<std::size_t>(found - names_.begin());
        return place;
    };
    for (const CarriedFault& fault : carried_) {
        where_.push_back({station(fault, fault.spec.from), station(fault, fault.spec.parameters.text("to"))});
        next_foreign_.push_back(is_clash(fault) ? fault.spec.begin : cosim::kNever);
    }
}

bool AirFaults::meant(std::size_t fault, const Transmission& sent, const MeshFrame* frame,
                      std::size_t receiver) const {
    const Where& where = where_[fault];
    if (where.from && *where.from != sent.station) return false;
    if (where.to && *where.to != receiver) return false;
    const cosim::FaultSpec& spec = carried_[fault].spec;
    const std::string kind = spec.parameters.text("frame", "any");
    if (kind != "any" && kind != name_of(frame)) return false;
    if (spec.match.empty()) return true;
    return frame && std::search(frame->data.begin(), frame->data.end(), spec.match.begin(),
                                spec.match.end()) != frame->data.end();
}

std::string AirFaults::describe(const Transmission& sent, const MeshFrame* frame,
                                std::size_t receiver) const {
    std::string text =
        fmt::format("{} from {} to {}", name_of(frame), names_[sent.station], names_[receiver]);
    if (frame) text += fmt::format(" sequence {} hop {}", frame->sequence, frame->hops + 1);
    return text;
}

/// False if the receiver's check finds it.
bool AirFaults::corrupt(CarriedFault& fault, std::optional<MeshFrame>& frame) {
    if (!frame) return false;
    auto octets = protocols::encode_mesh(*frame);
    const auto bits = std::min<std::size_t>(8 * octets.size(),
                                            static_cast<std::size_t>(fault.spec.parameters.number("bits")));
    for (std::set<std::uint64_t> chosen; chosen.size() < bits;) {
        const std::uint64_t bit = fault.trigger.random().below(8 * octets.size());
        if (!chosen.insert(bit).second) continue;
        octets[bit / 8] = static_cast<std::uint8_t>(octets[bit / 8] ^ 1u << bit % 8);
    }
    auto reading = protocols::decode_mesh(octets);
    if (reading.fault != protocols::MeshFault::None) return false;
    frame = std::move(reading.frame);
    return true;
}

bool AirFaults::read(const Transmission& sent, std::optional<MeshFrame>& frame, std::size_t receiver) {
    for (std::size_t f = 0; f < carried_.size(); ++f) {
        CarriedFault& fault = carried_[f];
        const MeshFrame* const view = frame ? &*frame : nullptr;
        if (is_clash(fault) || !meant(f, sent, view, receiver) || !fault.trigger.fires(sent.start)) continue;
        fault.evidence.fire({sent.start, sent.id, {}, describe(sent, view, receiver)}, sent.end);
        if (fault.spec.kind == "loss" || !corrupt(fault, frame)) return false;
    }
    return true;
}

void AirFaults::advance(Medium& medium, Time until) {
    for (std::size_t f = 0; f < carried_.size(); ++f) {
        const cosim::FaultParameters& given = carried_[f].spec.parameters;
        while (next_foreign_[f] < std::min(until, carried_[f].spec.end)) {
            Transmission foreign;
            foreign.id = kForeignId + foreign_++;
            foreign.station = kForeignStation + f;
            foreign.channel = static_cast<std::uint8_t>(given.number("channel"));
            foreign.dbm = given.number("dbm");
            if (where_[f].to) foreign.only = *where_[f].to;
            const Time length = given.time("length");
            foreign.start = next_foreign_[f];
            foreign.end = foreign.start + length;
            // Pauses are even around what leaves the air busy for this share of the time.
            const double load = given.number("load"),
                         pause = static_cast<double>(length) * (1.0 - load) / load;
            next_foreign_[f] =
                foreign.end + static_cast<Time>(2.0 * pause * carried_[f].trigger.random().uniform());
            if (foreign.end > until - kForeignMemory) medium.add(foreign);
        }
    }
}

void AirFaults::spoilt(const Transmission& foreign, const Transmission& sent, std::size_t receiver) {
    CarriedFault& fault = carried_[foreign.station - kForeignStation];
    fault.evidence.fire(
        {sent.start,
         sent.id,
         {},
         fmt::format("a frame from {} is not read by {}", names_[sent.station], names_[receiver])},
        sent.end);
}

void AirFaults::kept_waiting(const Transmission& foreign, std::size_t sender, Time now) {
    CarriedFault& fault = carried_[foreign.station - kForeignStation];
    fault.fired(now, foreign.id - kForeignId, fmt::format("{} waits for a free channel", names_[sender]));
}

}  // namespace puckloop::radio
