#include "emu/network/network_faults.h"

#include "base/error.h"
#include "protocols/network/ip_packet.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace puckloop::network {

using cosim::CarriedFault;
using cosim::Time;

namespace {
constexpr const char* kAway = "access_point_away";

/// Carried out packet by packet, each at its receiver.
bool is_of_packets(const std::string& kind) {
    return kind != "rate" && kind != "connection_reset" && kind != "address_clash" && kind != kAway;
}

cosim::Octets spoilt(const cosim::Octets& octets, std::size_t bits, RandomStream& random) {
    std::vector<std::uint8_t> changed(octets.view().begin(), octets.view().end());
    bits = std::min(bits, 8 * changed.size());
    for (std::set<std::uint64_t> chosen; chosen.size() < bits;) {
        const std::uint64_t bit = random.below(8 * changed.size());
        if (!chosen.insert(bit).second) continue;
        changed[bit / 8] = static_cast<std::uint8_t>(changed[bit / 8] ^ 1u << bit % 8);
    }
    return cosim::Octets(changed);
}
}  // namespace

NetworkFaults::NetworkFaults(std::vector<CarriedFault> faults, std::vector<std::string> names)
    : carried_(std::move(faults)), names_(std::move(names)) {
    const auto place_of = [this](const CarriedFault& fault, const std::string& name) {
        const auto found = std::find(names_.begin(), names_.end(), name);
        if (found == names_.end())
            throw InputError("", "fault " + fault.spec.name,
                             fmt::format("there is no '{}' on the network", name),
                             fmt::format("one of {}", fmt::join(names_, ", ")));
        return static_cast<std::size_t>(found - names_.begin());
    };
    for (const CarriedFault& fault : carried_) {
        Where where;
        if (!fault.spec.from.empty()) where.from = place_of(fault, fault.spec.from);
        if (const std::string to = fault.spec.parameters.text("to"); !to.empty())
            where.to = place_of(fault, to);
        const std::string group = fault.spec.parameters.text("group");
        if (!group.empty()) where.group.resize(names_.size());
        for (std::size_t begin = 0; begin < group.size();) {
            const std::size_t end = std::min(group.find('+', begin), group.size());
            where.group[place_of(fault, group.substr(begin, end - begin))] = true;
            begin = end + 1;
        }
        where_.push_back(std::move(where));
    }
    clashes_.resize(carried_.size());
    resets_.resize(carried_.size());
}

bool NetworkFaults::meant(std::size_t fault, const Passage& sent) const {
    const Where& where = where_[fault];
    if (where.from && *where.from != sent.from) return false;
    if (where.to && *where.to != sent.to) return false;
    if (!where.group.empty() && where.group[sent.from] == where.group[sent.to]) return false;
    const auto& match = carried_[fault].spec.match;
    const auto octets = sent.octets.view();
    return match.empty() ||
           std::search(octets.begin(), octets.end(), match.begin(), match.end()) != octets.end();
}

std::string NetworkFaults::describe(const Passage& sent) const {
    const auto packet = protocols::decode_ip(sent.octets.view());
    return fmt::format("{} to {}: {}", names_[sent.from], names_[sent.to],
                       packet ? protocols::describe(*packet) : "a damaged packet");
}

double NetworkFaults::rate(double rate, Time time, std::size_t from, std::uint64_t number) {
    for (std::size_t f = 0; f < carried_.size(); ++f) {
        CarriedFault& fault = carried_[f];
        if (fault.spec.kind != "rate" || !fault.trigger.open(time)) continue;
        if (where_[f].from && *where_[f].from != from) continue;
        const double cap = fault.spec.parameters.number("rate");
        if (rate != 0 && rate <= cap) continue;
        rate = cap;
        fault.fired(time, number, fmt::format("a packet of {}", names_[from]));
    }
    return rate;
}

bool NetworkFaults::is_away(Time time) const {
    return std::any_of(carried_.begin(), carried_.end(), [time](const CarriedFault& fault) {
        return fault.spec.kind == kAway && fault.trigger.open(time);
    });
}

std::vector<Time> NetworkFaults::away_changes() const {
    std::set<Time> times;
    for (const CarriedFault& fault : carried_)
        if (fault.spec.kind == kAway) times.insert({fault.trigger.begin(), fault.trigger.end()});
    times.erase(cosim::kNever);
    return {times.begin(), times.end()};
}

void NetworkFaults::missed(Time time, std::uint64_t number, const std::string& what, Time known) {
    for (CarriedFault& fault : carried_)
        if (fault.spec.kind == kAway && fault.trigger.open(time))
            fault.evidence.fire({time, number, {}, what}, known);
}

/// A connection is a candidate, once its octet passes.
void NetworkFaults::reset(std::size_t index, const Passage& sent, std::vector<Passage>& passing) {
    CarriedFault& fault = carried_[index];
    const auto octet = static_cast<std::uint64_t>(fault.spec.parameters.number("byte"));
    switch (resets_[index].look(sent, meant(index, sent), octet)) {
    case ResetConnections::Verdict::Passes:
        return;
    case ResetConnections::Verdict::Reaches:
        if (!fault.trigger.fires(sent.start)) return;
        fault.evidence.fire({sent.start, sent.number, {}, describe(sent)}, sent.arrival);
        passing = resets_[index].reset(sent, octet);
        return;
    case ResetConnections::Verdict::Dead:
        passing.clear();
        if (const auto answer = reset_to_sender(sent)) passing.push_back(*answer);
        return;
    }
}

void NetworkFaults::clash(std::size_t index, const Passage& sent, std::vector<Passage>& passing) {
    CarriedFault& fault = carried_[index];
    const cosim::FaultParameters& given = fault.spec.parameters;
    if (sent.many || !fault.trigger.open(sent.start) || !meant(index, sent)) return;
    if (!clashes_[index].goes_astray(sent, given.number("share"), given.time("cache"),
                                     fault.trigger.random()))
        return;
    fault.evidence.fire({sent.start, sent.number, {}, describe(sent)}, sent.arrival);
    passing.clear();
    if (given.text("answers") != "reset") return;
    if (const auto answer = reset_to_sender(sent)) passing.push_back(*answer);
}

std::vector<Passage> NetworkFaults::pass(const Passage& sent) {
    std::vector<Passage> passing{sent};
    for (std::size_t f = 0; f < carried_.size() && !passing.empty(); ++f) {
        const std::string& kind = carried_[f].spec.kind;
        if (kind == "connection_reset")
            reset(f, sent, passing);
        else if (kind == "address_clash")
            clash(f, sent, passing);
        if (is_of_packets(kind) && meant(f, sent)) suffer(f, sent, passing);
    }
    return passing;
}

void NetworkFaults::suffer(std::size_t index, const Passage& sent, std::vector<Passage>& passing) {
    CarriedFault& fault = carried_[index];
    const std::string& kind = fault.spec.kind;
    const bool holds = kind == "partition";
    if (holds ? !fault.trigger.open(sent.start) : !fault.trigger.fires(sent.start)) return;
    fault.evidence.fire({sent.start, sent.number, {}, describe(sent)}, sent.arrival);
    const cosim::FaultParameters& given = fault.spec.parameters;
    RandomStream& random = fault.trigger.random();
    if (holds || kind == "loss") {
        passing.clear();
    } else if (kind == "duplicate") {
        passing.push_back(passing.back());
        passing.back().arrival += kBehind;
    } else if (kind == "delay") {
        const auto jitter = static_cast<double>(given.time("jitter"));
        const Time later = given.time("delay") + static_cast<Time>(jitter * (2 * random.uniform() - 1));
        for (Passage& one : passing)
            one.arrival += std::max<Time>(later, 0);
    } else if (kind == "corrupt") {
        for (Passage& one : passing)
            one.octets = spoilt(one.octets, static_cast<std::size_t>(given.number("bits")), random);
    } else {  // reorder
        for (Passage& one : passing)
            held_.push_back({one.arrival + given.time("delay"), one});
        passing.clear();
    }
}

std::vector<Passage> NetworkFaults::take_held(std::size_t from, std::size_t to, Time arrival) {
    std::vector<Passage> taken;
    std::erase_if(held_, [&](Held& held) {
        if (held.passage.from != from || held.passage.to != to) return false;
        held.passage.arrival = std::min(held.latest, arrival + kBehind);
        taken.push_back(std::move(held.passage));
        return true;
    });
    return taken;
}

std::vector<Passage> NetworkFaults::take_held_before(Time until) {
    std::vector<Passage> taken;
    std::erase_if(held_, [&](Held& held) {
        if (held.latest >= until) return false;
        held.passage.arrival = held.latest;
        taken.push_back(std::move(held.passage));
        return true;
    });
    return taken;
}

Time NetworkFaults::next_held() const {
    Time next = cosim::kNever;
    for (const Held& held : held_)
        next = std::min(next, held.latest);
    return next;
}

}  // namespace puckloop::network
