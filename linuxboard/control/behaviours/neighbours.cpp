#include "linuxboard/control/behaviours/neighbours.h"

#include "linuxboard/control/rab/rab_range.h"

#include <cmath>
#include <cstdio>

namespace puckloop::control {

namespace {

constexpr double kForget = 1.0;        // s
constexpr double kAverageOver = 0.3;   // s
constexpr double kReportPeriod = 1.0;  // s

}  // namespace

void Neighbourhood::update(double now, std::span<const RabPacket> packets) {
    for (const RabPacket& packet : packets) {
        const int id = static_cast<int>(packet.payload & kIdMask);
        if (id == 0 || id == own_id_) continue;
        ++counts_[id];
        const auto [place, fresh] = entries_.try_emplace(id);
        Entry& entry = place->second;
        const double weight =
            fresh ? 1 : 1 - std::exp(-std::max(0.001, packet.time - entry.heard) / kAverageOver);
        entry.ahead += weight * (std::cos(packet.bearing) - entry.ahead);
        entry.left += weight * (std::sin(packet.bearing) - entry.left);
        entry.strength += weight * (packet.strength - entry.strength);
        entry.data = packet.payload >> kIdBits;
        entry.heard = packet.time;
    }
    std::erase_if(entries_, [&](const auto& one) { return now - one.second.heard > kForget; });
}

std::vector<Neighbour> Neighbourhood::list(double now) const {
    std::vector<Neighbour> out;
    for (const auto& [id, entry] : entries_)
        out.push_back({id, entry.data, std::atan2(entry.left, entry.ahead), range_cm(entry.strength, gain_),
                       now - entry.heard});
    return out;
}

std::string Neighbourhood::delivery(double now) {
    if (counted_from_ < 0) counted_from_ = now;
    const double elapsed = now - counted_from_;
    if (elapsed < kReportPeriod) return {};
    std::string text;
    for (const auto& [id, count] : counts_) {
        char part[64];
        const auto entry = entries_.find(id);
        std::snprintf(part, sizeof part, "%s%d: %.0f", text.empty() ? "" : ", ", id,
                      static_cast<double>(count) / elapsed);
        text += part;
        if (entry == entries_.end()) continue;
        std::snprintf(part, sizeof part, " (%.0f cm)", range_cm(entry->second.strength, gain_));
        text += part;
    }
    counts_.clear();
    counted_from_ = now;
    return "messages a second: " + (text.empty() ? "none" : text);
}

}  // namespace puckloop::control
