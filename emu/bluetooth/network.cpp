#include "emu/bluetooth/network.h"

#include "emu/air/power.h"
#include "protocols/radio/lmx9820_packet.h"

#include <algorithm>
#include <utility>

namespace puckloop::bluetooth {

using cosim::Time;

Network::Network(const Times& times, double range, std::uint64_t seed, AirLog log)
    : times_(times), range_(range), seed_(seed), log_(std::move(log)) {}

std::size_t Network::add(Station& station) {
    const auto stream = [&](const char* use) {
        return RandomStream(seed_, std::string(station.name()) + ".bluetooth/" + use);
    };
    members_.push_back(
        {&station, std::nullopt, stream("discovery"), stream("name"), stream("link"), stream("release")});
    return members_.size() - 1;
}

void Network::note(Time now, std::size_t who, std::string_view what, std::string_view whom, Time since) {
    if (log_) log_(now, members_[who].station->name(), what, whom, since);
}

std::string Network::name_of(const Address& address) const {
    for (const Member& member : members_)
        if (member.station->address() == address) return std::string(member.station->name());
    return protocols::lmx_address_text(address);
}

bool Network::near(std::size_t a, std::size_t b) const {
    const auto &p = members_[a].at, &q = members_[b].at;
    return !p || !q || air::distance(*p, *q) <= range_;
}

std::optional<std::size_t> Network::reach(std::size_t station, const Address& address) const {
    for (std::size_t other = 0; other < members_.size(); ++other) {
        const Station& there = *members_[other].station;
        if (other != station && there.address() == address && there.connectable() && near(station, other))
            return other;
    }
    return std::nullopt;
}

void Network::place(std::size_t station, std::array<double, 2> at, Time now) {
    if (members_[station].at == at) return;
    members_[station].at = at;
    for (auto& [id, link] : links_)
        if (link.ends[0] == station || link.ends[1] == station) look_at(id, link, now);
}

void Network::inquire(std::size_t station, Time length, unsigned most, Time now) {
    Member& member = members_[station];
    ++counts_.inquiries;
    member.inquiry = {next_token_++, most, 0, now};
    // One number for each device, whoever is near: what one run draws does not hang on where robots stand.
    for (std::size_t other = 0; other < members_.size(); ++other) {
        if (other == station) continue;
        const Time after = draw_exponential(times_.discovery, member.discovery);
        if (after < length)
            agenda_.add(now + after, {EventKind::Found, station, other, member.inquiry.token});
        else if (near(station, other) && members_[other].station->discoverable())
            ++counts_.missed;
    }
    agenda_.add(now + length, {EventKind::InquiryOver, station, station, member.inquiry.token});
}

void Network::answer_inquiry(const Event& event, Time now) {
    Member& member = members_[event.station];
    const Station& there = *members_[event.other].station;
    if (member.inquiry.token != event.token || !there.discoverable() || !near(event.station, event.other))
        return;
    ++counts_.found;
    ++member.inquiry.found;
    note(now, event.station, "found", there.name(), member.inquiry.since);
    member.station->found(there.address(), there.device_class(), now);
    if (member.inquiry.found == member.inquiry.most) end_inquiry(event.station, now);
}

void Network::end_inquiry(std::size_t station, Time now) {
    Member& member = members_[station];
    note(now, station, "inquiry over", "", member.inquiry.since);
    member.inquiry = {};
    member.station->inquiry_over(now);
}

void Network::ask_name(std::size_t station, const Address& address, Time now) {
    Member& member = members_[station];
    ++counts_.names;
    const std::uint64_t token = next_token_++;
    member.asks[token] = {address, 0, 0, now};
    const Time after = draw(times_.name, member.name);
    if (reach(station, address))
        agenda_.add(now + after, {EventKind::Named, station, station, token});
    else
        agenda_.add(now + times_.page_timeout, {EventKind::NameMissing, station, station, token});
}

void Network::name_through(const Event& event, Time now) {
    Member& member = members_[event.station];
    const auto ask = member.asks.extract(event.token);
    if (ask.empty()) return;
    const Address address = ask.mapped().address;
    std::optional<std::string> name;
    if (event.kind == EventKind::Named)
        if (const auto other = reach(event.station, address))
            name = members_[*other].station->friendly_name();
    if (!name) ++counts_.names_missing;
    note(now, event.station, name ? "named" : "no name", name_of(address), ask.mapped().since);
    member.station->named(address, name, now);
}

void Network::connect(std::size_t station, const Address& address, std::uint8_t port,
                      std::uint8_t remote_port, Time now) {
    Member& member = members_[station];
    ++counts_.attempts;
    const std::uint64_t token = next_token_++;
    member.asks[token] = {address, port, remote_port, now};
    const Time after = draw(times_.link, member.link);
    if (reach(station, address))
        agenda_.add(now + after, {EventKind::Linked, station, station, token});
    else
        agenda_.add(now + times_.page_timeout, {EventKind::NotLinked, station, station, token});
}

std::uint8_t Network::admit(std::size_t from, std::size_t to, std::uint8_t remote_port) {
    Station &here = *members_[from].station, &there = *members_[to].station;
    if (const std::uint8_t state = there.port_state(remote_port); state != kRfcommOk) return state;
    if (!here.authenticates() && !there.authenticates()) return kRfcommOk;
    const Address mine = here.address(), yours = there.address();
    if (here.has_key(yours) && there.has_key(mine)) return kRfcommOk;
    if (here.pin(yours) != there.pin(mine)) return kRfcommRejected;
    here.keep_key(yours);
    there.keep_key(mine);
    return kRfcommOk;
}

void Network::link_through(const Event& event, Time now) {
    Member& member = members_[event.station];
    const auto node = member.asks.extract(event.token);
    if (node.empty()) return;
    const Ask ask = node.mapped();
    std::uint8_t status = kRfcommNobody;
    const auto other = reach(event.station, ask.address);
    if (event.kind == EventKind::Linked && other) status = admit(event.station, *other, ask.remote_port);
    LinkId id = 0;
    if (status == kRfcommOk) {
        ++counts_.links;
        id = next_token_++;
        Link link;
        link.ends = {event.station, *other};
        link.since = now;
        links_.emplace(id, std::move(link));
    } else {
        ++(status == kRfcommNobody ? counts_.not_found : counts_.refused);
    }
    note(now, event.station,
         id != 0 ? "linked" : (status == kRfcommNobody ? "nobody to link with" : "link refused"),
         name_of(ask.address), ask.since);
    if (id != 0) members_[*other].station->incoming(member.station->address(), ask.remote_port, id, now);
    member.station->linked(ask.address, ask.port, ask.remote_port, status, id, now);
}

void Network::send(std::size_t station, LinkId link, Bytes bytes, Time now) {
    agenda_.add(now + times_.latency, {EventKind::Deliver, station, 0, link, 0, std::move(bytes)});
}

void Network::deliver(const Event& event, Time now) {
    const auto found = links_.find(event.token);
    if (found == links_.end()) {
        counts_.bytes_lost += event.bytes.size();
        return;
    }
    Link& link = found->second;
    const std::size_t from = link.ends[0] == event.station ? 0 : 1;
    // Without bytes: the other end is heard again. Until then, and while it is not heard, bytes queue.
    if (!event.bytes.empty()) link.held[from].push_back(event.bytes);
    if (!link.heard || (link.resumes[from] && !event.bytes.empty())) return;
    link.resumes[from] = false;
    const std::deque<Bytes> through = std::exchange(link.held[from], {});
    for (const Bytes& bytes : through) {
        counts_.bytes += bytes.size();
        members_[link.ends[1 - from]].station->received(event.token, bytes, now);
    }
}

void Network::release(std::size_t station, LinkId link, Time now) {
    const Time after = draw(times_.release, members_[station].release);
    agenda_.add(now + after, {EventKind::Released, station, 0, link});
}

void Network::gone(std::size_t station, Time now) {
    Member& member = members_[station];
    member.inquiry = {};
    member.asks.clear();
    for (auto it = links_.begin(); it != links_.end();) {
        const auto id = it->first;
        Link& link = (it++)->second;
        for (std::size_t end = 0; end < 2; ++end)
            if (link.ends[end] == station) link.there[end] = false;
        if (!link.there[0] && !link.there[1])
            links_.erase(id);
        else
            look_at(id, link, now);
    }
}

void Network::look_at(LinkId id, Link& link, Time now) {
    const bool heard = link.there[0] && link.there[1] && near(link.ends[0], link.ends[1]);
    if (heard == link.heard) return;
    link.heard = heard;
    if (!heard) {
        Time timeout = cosim::kNever;
        for (std::size_t end = 0; end < 2; ++end)
            if (link.there[end])
                timeout = std::min(timeout, members_[link.ends[end]].station->link_timeout());
        agenda_.add(cosim::later(now, timeout), {EventKind::Lost, 0, 0, id, ++link.turn});
        return;
    }
    ++link.turn;
    link.resumes = {true, true};
    for (const std::size_t end : link.ends)
        agenda_.add(now + times_.latency, {EventKind::Deliver, end, 0, id});
}

void Network::end_link(LinkId id, std::array<std::uint8_t, 2> reasons, std::string_view what, Time now) {
    const auto node = links_.extract(id);
    if (node.empty()) return;
    const Link& link = node.mapped();
    for (const auto& queue : link.held)
        for (const Bytes& bytes : queue)
            counts_.bytes_lost += bytes.size();
    for (std::size_t end = 0; end < 2; ++end) {
        if (!link.there[end]) continue;
        note(now, link.ends[end], what, members_[link.ends[1 - end]].station->name(), link.since);
        members_[link.ends[end]].station->released(id, reasons[end], now);
    }
}

void Network::step() {
    const Time now = agenda_.next();
    happen(agenda_.take(), now);
}

void Network::happen(const Event& event, Time now) {
    switch (event.kind) {
    case EventKind::Found:
        return answer_inquiry(event, now);
    case EventKind::InquiryOver:
        if (members_[event.station].inquiry.token == event.token) end_inquiry(event.station, now);
        return;
    case EventKind::Named:
    case EventKind::NameMissing:
        return name_through(event, now);
    case EventKind::Linked:
    case EventKind::NotLinked:
        return link_through(event, now);
    case EventKind::Deliver:
        return deliver(event, now);
    case EventKind::Released: {
        const auto found = links_.find(event.token);
        if (found == links_.end()) return;
        const bool first = found->second.ends[0] == event.station;
        return end_link(event.token,
                        {first ? kReleasedHere : kReleasedThere, first ? kReleasedThere : kReleasedHere},
                        "released", now);
    }
    case EventKind::Lost: {
        const auto found = links_.find(event.token);
        if (found == links_.end() || found->second.heard || found->second.turn != event.turn) return;
        ++counts_.lost;
        return end_link(event.token, {kLinkLost, kLinkLost}, "lost", now);
    }
    default:
        return members_[event.station].station->happen(event, now);
    }
}

}  // namespace puckloop::bluetooth
