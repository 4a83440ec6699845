// The mesh of a wireless network: packets go over stations between, by the ways that Routes finds; those for
// all are passed on by every station once.

#include "base/error.h"
#include "base/files/new_file.h"
#include "base/json.h"
#include "emu/wifi/wifi_node.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::wifi {

using cosim::Time;

namespace {

/// Those that got a packet for all at the same instant wait for different times before they pass it on: RFC
/// 5148, 5.2 asks for as much; drawn evenly.
constexpr Time kMostJitter = 10 * cosim::kMillisecond;
constexpr std::uint64_t kRemembered = 10'000;  // packets: no older one is still on its way

}  // namespace

void WifiNode::begin_mesh() {
    if (spec_.access_point)
        throw InputError("", "network " + spec_.name, "a mesh has no access point", "one of the two");
    mesh_.emplace(
        Mesh{Routes(names_.size(), spec_.settings.mesh_hops), 0, RandomStream(spec_.seed, "wifi mesh")});
    mesh_->flooded.resize(names_.size());
    mesh_->passed_on.resize(names_.size());
    if (!spec_.routes_csv.empty()) {
        mesh_->csv = new_file(spec_.routes_csv);
        if (mesh_->csv == nullptr) throw RunError(fmt::format("{}: cannot be written", spec_.routes_csv));
        fmt::print(mesh_->csv, "time_s,from,to,next,hops\n");
    }
    find_ways(0);
}

void WifiNode::find_ways(Time now) {
    mesh_->next_update += std::max<Time>(cosim::from_seconds(spec_.settings.route_every), 1);
    for (const Routes::Change& change : mesh_->routes.update(dcf_)) {
        if (now > 0) ++mesh_->changes;
        if (mesh_->csv == nullptr) continue;
        fmt::print(mesh_->csv, "{:.6f},{},{},{},{}\n", cosim::to_seconds(now), names_[change.from],
                   names_[change.to], change.hops == 0 ? "" : names_[change.next], change.hops);
    }
}

bool WifiNode::is_new_at(std::size_t station, std::uint64_t number) {
    std::set<std::uint64_t>& had = mesh_->flooded[station];
    if (!had.insert(number).second) return false;
    while (*had.begin() + kRemembered < number)
        had.erase(had.begin());
    return true;
}

/// A frame that a station is to send: its own, or another one's that it passes on.
void WifiNode::mesh_submit(std::size_t station, Frame frame, Time now) {
    const bool own = frame.hops == 0;
    if (frame.to == kEveryStation) {
        if (own) is_new_at(station, frame.number);
        frame.hop_to = kEveryStation;
    } else {
        frame.hop_to = mesh_->routes.next(station, frame.to);
        if (frame.hop_to == Routes::kNoWay) {
            ++mesh_->no_way;
            return;
        }
    }
    ++frame.hops;
    const std::size_t from = frame.from;
    if (!own) ++mesh_->passed_on[station];
    if (!dcf_.submit(station, std::move(frame), now) && own) ++computers_.counts(from).queue_full;
}

void WifiNode::mesh_received(std::size_t station, const Frame& frame, const Transmission& last) {
    const bool many = frame.to == kEveryStation;
    if (many && !is_new_at(station, frame.number)) return;
    if (many || frame.to == station) deliver(frame, computer_of_[station], last.start, last.end);
    if (frame.to == station || frame.hops >= spec_.settings.mesh_hops) return;
    const Time wait = many ? static_cast<Time>(mesh_->jitter.below(kMostJitter)) : 0;
    if (wait == 0) return submit(station, frame, last.end);
    waiting_.emplace(std::pair(last.end + wait, waits_++), Waiting{station, frame});
}

nlohmann::ordered_json WifiNode::mesh_report() {
    if (mesh_->csv != nullptr) std::fflush(mesh_->csv);
    nlohmann::ordered_json passed = nlohmann::ordered_json::object();
    for (std::size_t station = 0; station < names_.size(); ++station)
        passed[names_[station]] = mesh_->passed_on[station];
    return {{"route_changes", mesh_->changes}, {"no_way", mesh_->no_way}, {"passed_on", std::move(passed)}};
}

}  // namespace puckloop::wifi
