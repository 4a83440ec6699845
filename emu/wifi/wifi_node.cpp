#include "emu/wifi/wifi_node.h"

#include "base/error.h"
#include "base/files/new_file.h"
#include "base/json.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::wifi {

using cosim::kNever;
using cosim::Time;
using protocols::IpAddress;

namespace {

constexpr const char* kAccessPoint = "access_point";

std::vector<network::Station> computers_of(const WifiSpec& spec) {
    std::vector<network::Station> computers;
    for (const WifiStation& station : spec.stations)
        computers.push_back(station.computer);
    return computers;
}

/// Stations: computers that are not wired, in their order, then the access point.
std::vector<std::string> station_names(const WifiSpec& spec) {
    std::vector<std::string> names;
    for (const WifiStation& station : spec.stations)
        if (!station.wired) names.push_back(station.computer.name);
    if (spec.access_point) names.emplace_back(kAccessPoint);
    return names;
}

std::vector<Position> station_positions(const WifiSpec& spec) {
    std::vector<Position> positions;
    for (const WifiStation& station : spec.stations)
        if (!station.wired) positions.push_back(station.at);
    if (spec.access_point) positions.push_back(*spec.access_point);
    return positions;
}

constexpr protocols::MacAddress kMacOfAccessPoint{0x02, 0, 0, 0, 0, 0x01};

/// An address that Computers has accepted.
protocols::MacAddress mac_of_text(const std::string& address) {
    return protocols::mac_of(protocols::address_of(address).value_or(0));
}

/// Of the stations.
std::vector<protocols::MacAddress> macs_of(const WifiSpec& spec) {
    std::vector<protocols::MacAddress> macs;
    for (const WifiStation& station : spec.stations)
        if (!station.wired) macs.push_back(mac_of_text(station.computer.address));
    if (spec.access_point) macs.push_back(kMacOfAccessPoint);
    return macs;
}

nlohmann::ordered_json to_json(const DcfCounts& counts) {
    return {{"frames", counts.frames},
            {"again", counts.again},
            {"acks", counts.acks},
            {"dropped", counts.dropped},
            {"read", counts.read},
            {"read_twice", counts.twice},
            {"weak", counts.losses.weak},
            {"noise", counts.losses.noise},
            {"collisions", counts.losses.collisions},
            {"sending", counts.losses.sending},
            {"away", counts.losses.away},
            {"air_s", cosim::to_seconds(counts.air)}};
}

}  // namespace

WifiNode::WifiNode(const WifiSpec& spec)
    : spec_(spec),
      computers_(spec.name, spec.prefix, computers_of(spec), spec.faults),
      ports_(computers_.ports()),
      names_(station_names(spec)),
      dcf_(spec.settings, names_, station_positions(spec), spec.queue, spec.seed, *this),
      free_(spec.stations.size()) {
    for (std::size_t c = 0; c < spec.stations.size(); ++c) {
        const bool wired = spec.stations[c].wired;
        if (wired && !spec.access_point)
            throw InputError("", "network " + spec.name,
                             fmt::format("{} is wired to no access point", spec.stations[c].computer.name),
                             "an access point, or a position");
        any_wired_ = any_wired_ || wired;
        station_of_.push_back(wired ? kNobody : computer_of_.size());
        if (!wired) computer_of_.push_back(c);
        const int pose = spec.stations[c].pose;
        if (pose >= 0) dcf_.medium().embody(station_of_[c]);
        for (std::size_t axis = 0; pose >= 0 && !wired && axis < 2; ++axis)
            coordinates_[pose + static_cast<int>(axis)] = {station_of_[c], axis};
    }
    if (spec.access_point) computer_of_.push_back(kNobody);
    dcf_.medium().set_obstacles({spec.obstacles, spec.first_shape, spec.settings.thing_loss});
    if (spec.settings.mesh) begin_mesh();
    away_changes_ = computers_.faults().away_changes();
    if (!away_changes_.empty() && !spec.access_point)
        throw InputError("", "network " + spec.name, "there is no access point that could be away",
                         "access_point in [network]");
    ports_.push_back({"world", cosim::PortKind::Signals});
    ports_.push_back({"messages", cosim::PortKind::Network});
    if (!spec_.pcapng.empty())
        capture_.emplace(spec_.pcapng, spec_.settings, macs_of(spec_),
                         spec_.access_point ? names_.size() - 1 : kEveryStation);
    if (spec_.csv.empty()) return;
    csv_ = new_file(spec_.csv);
    if (csv_ == nullptr) throw RunError(fmt::format("{}: cannot be written", spec_.csv));
    fmt::print(csv_, "time_s,end_s,from,to,kind,octets,rate_mbit_s,attempt,dbm,fate\n");
}

WifiNode::~WifiNode() {
    if (csv_ != nullptr) std::fclose(csv_);
    if (mesh_ && mesh_->csv != nullptr) std::fclose(mesh_->csv);
}

/// Everything before `until`.
void WifiNode::run(Time until) {
    for (;;) {
        const Time wait = waiting_.empty() ? kNever : waiting_.begin()->first.first;
        const Time air = dcf_.next();
        const Time away = next_away_ < away_changes_.size() ? away_changes_[next_away_] : kNever;
        const Time ways = mesh_ ? mesh_->next_update : kNever;
        if (std::min({wait, air, away, ways}) >= until) return;
        if (std::min(away, ways) <= std::min(wait, air)) {
            if (away <= ways)
                change_away(away);
            else
                find_ways(ways);
            continue;
        }
        // Who gets a packet at the time at which another one sends does not hear it yet.
        if (wait <= air) {
            const Waiting one = std::move(waiting_.begin()->second);
            waiting_.erase(waiting_.begin());
            submit(one.station, one.frame, wait);
        } else {
            dcf_.step();
        }
    }
}

void WifiNode::advance(Time until, std::span<const cosim::Message> inbox,
                       std::vector<cosim::Message>& outbox) {
    for (const cosim::Message& message : inbox) {
        run(message.time);
        if (const auto* packet = std::get_if<cosim::Packet>(&message.payload)) {
            if (message.port < computers_.size())
                take(message.port, *packet, message.time);
            else
                computers_.hand_in(*packet, message.time + lookahead(0));
        } else if (const auto* signal = std::get_if<cosim::Signal>(&message.payload)) {
            place(*signal);
        }
    }
    run(until);
    computers_.hand_over(until, outbox);
    granted_ = until;
}

void WifiNode::place(const cosim::Signal& signal) {
    if (dcf_.medium().obstacles().take(static_cast<int>(signal.id), signal.value)) return;
    const auto found = coordinates_.find(static_cast<int>(signal.id));
    if (found == coordinates_.end()) return;
    const auto [station, axis] = found->second;
    Position at = dcf_.medium().position(station);
    at[axis] = signal.value;
    dcf_.medium().move(station, at);
}

void WifiNode::change_away(Time now) {
    ++next_away_;
    const bool away = computers_.faults().is_away(now);
    if (away == away_) return;
    away_ = away;
    for (const Frame& frame : dcf_.set_away(computer_of_.size() - 1, away))
        missed(frame, now);
}

void WifiNode::missed(const Frame& frame, Time now) {
    computers_.faults().missed(now, frame.number,
                               fmt::format("a packet of {} in the access point", computers_.name(frame.from)),
                               now);
}

void WifiNode::submit(std::size_t station, Frame frame, Time now) {
    const std::size_t from = frame.from;
    if (away_ && is_access_point(station)) return missed(frame, now);
    if (mesh_) return mesh_submit(station, std::move(frame), now);
    if (!dcf_.submit(station, std::move(frame), now) && computer_of_[station] == from)
        ++computers_.counts(from).queue_full;
}

/// Of a packet for many the first that it is for; kNobody: nobody has the address.
std::size_t WifiNode::computer_of(IpAddress to, std::size_t from) const {
    for (std::size_t c = 0; c < computers_.size(); ++c)
        if (c != from && computers_.is_for(c, to)) return c;
    return kNobody;
}

void WifiNode::take(std::size_t from, const cosim::Packet& packet, Time now) {
    network::ComputerCounts& counts = computers_.counts(from);
    const auto read = protocols::decode_ip(packet.octets.view());
    if (!read) return;
    ++counts.sent;
    counts.octets_sent += packet.octets.size();
    const std::uint64_t number = packets_++;
    const std::size_t to = computer_of(read->to, from);
    if (to == kNobody) {
        ++counts.nobody;
        return;
    }
    Frame frame{.number = number, .from = from, .octets = packet.octets};
    // A capped computer hands its packets on one behind the other.
    Time ready = std::max(now, free_[from]);
    if (const double cap = computers_.faults().rate(0.0, ready, from, number); cap != 0.0) {
        ready += std::llround(8.0 * static_cast<double>(packet.octets.size()) / cap *
                              static_cast<double>(cosim::kSecond));
        free_[from] = ready;
    }
    const std::size_t station = station_of_[from];
    if (station == kNobody) return pass_on(frame, ready, nullptr);
    if (spec_.access_point)
        frame.hop_to = computer_of_.size() - 1;
    else
        frame.to = frame.hop_to = computers_.is_for_many(read->to) ? kEveryStation : station_of_[to];
    if (ready > now)
        waiting_.emplace(std::pair(ready, waits_++), Waiting{station, std::move(frame)});
    else
        submit(station, std::move(frame), now);
}

/// From the access point on, by wire and by radio. `last`: it came by this frame.
void WifiNode::pass_on(const Frame& frame, Time now, const Transmission* last) {
    const auto read = protocols::decode_ip(frame.octets.view());
    if (!read) return;
    const bool many = computers_.is_for_many(read->to);
    bool by_radio = false;
    Frame next = frame;
    for (std::size_t c = 0; c < computers_.size(); ++c) {
        if (c == frame.from || !computers_.is_for(c, read->to)) continue;
        if (station_of_[c] == kNobody) {
            if (away_) {
                missed(frame, now);
                continue;
            }
            deliver(frame, c, last != nullptr ? last->start : now, last != nullptr ? last->end : now);
        } else {
            by_radio = true;
            next.hop_to = many ? kEveryStation : station_of_[c];
        }
    }
    if (!by_radio) return;
    next.number = packets_++;  // a frame of its own
    // What comes by wire takes the latency to the access point.
    if (last == nullptr)
        waiting_.emplace(std::pair(now + spec_.latency, waits_++),
                         Waiting{computer_of_.size() - 1, std::move(next)});
    else
        submit(computer_of_.size() - 1, std::move(next), now);
}

void WifiNode::began(const Transmission& sent, const Frame* frame) {
    if (!capture_) return;
    if (frame == nullptr) return capture_->add(sent, nullptr, {}, {});
    const auto read = protocols::decode_ip(frame->octets.view());
    const IpAddress to = read ? read->to : 0;
    constexpr int kGroup = 0xe;  // addresses that begin with these four bits
    capture_->add(sent, frame, mac_of_text(spec_.stations[frame->from].computer.address),
                  !computers_.is_for_many(to) ? protocols::mac_of(to)
                  : to >> 28 == kGroup        ? protocols::group_mac(to)
                                              : protocols::kAllMac);
}

void WifiNode::received(std::size_t station, const Frame& frame, const Transmission& last) {
    if (is_access_point(station)) return pass_on(frame, last.end, &last);
    if (mesh_) return mesh_received(station, frame, last);
    if (computer_of_[station] == frame.from) return;  // its own broadcast, from the access point
    deliver(frame, computer_of_[station], last.start, last.end);
}

void WifiNode::deliver(const Frame& frame, std::size_t computer, Time start, Time end) {
    // Faults look at packets in the order of time.
    last_start_ = std::max(last_start_, start);
    computers_.deliver(
        {frame.number, frame.from, computer, last_start_, end - start, end + spec_.latency, frame.octets});
}

void WifiNode::became(const Transmission& sent, std::size_t station, Fate fate) {
    const std::string_view kind = sent.acknowledges              ? "ack"
                                  : sent.hop_to == kEveryStation ? "to_all"
                                                                 : "data";
    if (fate == Fate::Away)
        computers_.faults().missed(sent.end, sent.id,
                                   fmt::format("a frame of {} is not read", names_[sent.station]), sent.end);
    write(sent.start, sent.end, sent.station, names_[station], kind, &sent, sent.dbm[station],
          air::name_of(fate));
}

void WifiNode::dropped(std::size_t station, const Frame& frame, Time now) {
    write(now, now, station, names_[frame.hop_to], "data", nullptr, 0.0, "dropped");
}

void WifiNode::write(Time start, Time end, std::size_t from, std::string_view to, std::string_view kind,
                     const Transmission* sent, double dbm, std::string_view fate) {
    if (csv_ == nullptr) return;
    fmt::print(csv_, "{:.6f},{:.6f},{},{},{},", cosim::to_seconds(start), cosim::to_seconds(end),
               names_[from], to, kind);
    if (sent != nullptr)
        fmt::print(csv_, "{},{:g},{},{:.1f},", sent->octets, sent->rate->bits / 1e6, sent->attempt, dbm);
    else
        fmt::print(csv_, ",,,,");
    fmt::print(csv_, "{}\n", fate);
}

Time WifiNode::earliest_output(cosim::PortIndex port) const {
    if (port >= computers_.size()) return kNever;
    Time air = dcf_.earliest_end();
    if (!waiting_.empty()) air = std::min(air, waiting_.begin()->first.first + dcf_.phy().shortest_packet());
    return std::max(granted_, std::min(computers_.next(port), cosim::later(air, spec_.latency)));
}

Time WifiNode::lookahead(cosim::PortIndex port) const {
    if (port >= computers_.size()) return kNever;
    return spec_.latency + (any_wired_ ? 0 : dcf_.phy().shortest_packet());
}

std::string WifiNode::finish() {
    using nlohmann::ordered_json;
    ordered_json stations = ordered_json::object();
    for (std::size_t c = 0; c < computers_.size(); ++c) {
        ordered_json one = computers_.report(c);
        if (station_of_[c] != kNobody) one["radio"] = to_json(dcf_.counts(station_of_[c]));
        stations[computers_.name(c)] = std::move(one);
    }
    ordered_json report{{"stations", std::move(stations)}};
    if (spec_.access_point) {
        const DcfCounts& counts = dcf_.counts(computer_of_.size() - 1);
        report[kAccessPoint] = to_json(counts);
        report[kAccessPoint]["queue_full"] = counts.queue_full;
    }
    if (spec_.settings.bursts != 0)
        report["interference"] = {{"bursts", dcf_.bursts().count},
                                  {"air_s", cosim::to_seconds(dcf_.bursts().air)}};
    if (mesh_) report["mesh"] = mesh_report();
    if (csv_ != nullptr) std::fflush(csv_);
    if (capture_) capture_->flush();
    const network::NetworkFaults& faults = computers_.faults();
    if (!faults.empty()) report["faults"] = cosim::fault_results(faults.carried(), granted_);
    return report.dump();
}

}  // namespace puckloop::wifi
