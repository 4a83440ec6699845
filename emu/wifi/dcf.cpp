#include "emu/wifi/dcf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::wifi {

using cosim::kNever;
using cosim::Time;

namespace {

/// Exponential, a nanosecond at least; `mean` in s.
Time drawn_time(RandomStream& random, double mean) {
    constexpr Time kLeast = cosim::kMicrosecond / 1000;
    return std::max(kLeast, cosim::from_seconds(-std::log(1.0 - random.uniform()) * mean));
}

constexpr double kMargin = 3.0;  // dB, of a chosen rate: a thousandth of what is lost at the sensitivity

}  // namespace

Dcf::Dcf(const WifiSettings& settings, const std::vector<std::string>& names,
         const std::vector<Position>& positions, std::int64_t queue, std::uint64_t seed, DcfUser& user)
    : settings_(settings),
      phy_(settings),
      medium_(settings, names, positions, seed),
      user_(user),
      queue_(queue),
      burst_random_(seed, "wifi interference") {
    for (const std::string& name : names) {
        Station& station = stations_.emplace_back(RandomStream(seed, fmt::format("wifi backoff {}", name)),
                                                  RandomStream(seed, fmt::format("wifi noise {}", name)));
        station.window = phy_.first_window();
        station.last.resize(names.size());
    }
    plan_burst(0);
}

void Dcf::plan_burst(Time after) {
    if (settings_.bursts == 0) return;
    next_burst_ = after + drawn_time(burst_random_, 1.0 / settings_.bursts);
}

/// Noise from outside: no frame begins with it, so nobody takes it for one that could not be read.
void Dcf::burst(Time now) {
    Transmission noise;
    noise.id = ++transmissions_;
    noise.station = noise.hop_to = kInterference;
    noise.start = now;
    noise.end = now + drawn_time(burst_random_, settings_.burst_time);
    ++bursts_.count;
    bursts_.air += noise.end - now;
    plan_burst(noise.end);
    const Transmission& sent = medium_.add(std::move(noise));
    if (settings_.burst_power < settings_.carrier_sense) return;
    for (Station& station : stations_)
        found_busy(station, sent.start, sent.end);
}

void Dcf::burst_ended(Time now, double dbm) {
    medium_.forget();
    if (dbm < settings_.carrier_sense) return;
    for (Station& station : stations_) {
        if (station.plan != kNever && station.plan <= now) continue;
        rebase(station, 0);
        plan(station, now);
    }
}

const Rate& Dcf::rate_for(std::size_t station, std::size_t hop_to) const {
    if (hop_to == kEveryStation)
        return settings_.broadcast_rate == 0 ? phy_.slowest() : phy_.rate_of(settings_.broadcast_rate);
    if (settings_.rate != 0) return phy_.rate_of(settings_.rate);
    const double dbm = medium_.received_dbm(station, hop_to);
    const Rate* best = &phy_.slowest();
    for (const Rate& rate : phy_.rates())
        if (dbm >= rate.sensitivity_dbm + kMargin) best = &rate;
    return *best;
}

bool Dcf::is_neighbour(std::size_t a, std::size_t b) const {
    return std::min(medium_.received_dbm(a, b), medium_.received_dbm(b, a)) >=
           phy_.slowest().sensitivity_dbm + kMargin;
}

Time Dcf::time_of(std::size_t octets, const Rate& rate) const {
    return phy_.difs() + phy_.air_time(kFrameOctets + octets, rate) + phy_.sifs() +
           phy_.air_time(kAckOctets, phy_.ack_rate(rate));
}

void Dcf::draw(Station& station) {
    station.count =
        static_cast<std::int64_t>(station.backoff.below(static_cast<std::uint64_t>(station.window) + 1));
}

void Dcf::plan(Station& station, Time now) {
    station.plan = station.queue.empty() || station.sends
                       ? kNever
                       : std::max(now, station.base + station.count * phy_.slot());
}

void Dcf::rebase(Station& station, Time at_least) {
    const Time gap = station.unread ? phy_.eifs() : phy_.difs();
    station.base = std::max(station.busy_until + gap, at_least);
}

/// Of a station that hears a frame begin: its count stops.
void Dcf::found_busy(Station& station, Time start, Time end) {
    const bool was_busy = station.busy_until > start;
    if (!was_busy) {
        const Time counted = std::max<Time>(0, start - station.base) / phy_.slot();
        station.noticed = start + phy_.sensing();
        station.was_free = start >= station.base && station.count <= counted;
    }
    // One that sends before it can have noticed does so.
    const bool cannot_stop = station.plan != kNever && station.plan <= start + phy_.sensing();
    if (!was_busy && !cannot_stop)
        station.count -= std::clamp<Time>((start - station.base) / phy_.slot(), 0, station.count);
    station.busy_until = std::max(station.busy_until, end);
    if (cannot_stop) return;
    rebase(station, 0);
    plan(station, start);
}

void Dcf::put_on_air(Transmission transmission) {
    transmission.id = ++transmissions_;
    Station& sender = stations_[transmission.station];
    ++sender.counts.frames;
    sender.counts.air += transmission.end - transmission.start;
    const Transmission& sent = medium_.add(std::move(transmission));
    user_.began(sent, sent.acknowledges ? nullptr : &sender.queue.front());
    for (std::size_t s = 0; s < stations_.size(); ++s) {
        if (s == sent.station)
            stations_[s].busy_until = std::max(stations_[s].busy_until, sent.end);
        else if (sent.dbm[s] >= settings_.carrier_sense)
            found_busy(stations_[s], sent.start, sent.end);
    }
}

bool Dcf::submit(std::size_t number, Frame frame, Time now) {
    outlook_.reset();
    Station& station = stations_[number];
    if (static_cast<std::int64_t>(station.queue.size()) >= queue_) {
        ++station.counts.queue_full;
        return false;
    }
    const bool first = station.queue.empty();
    station.queue.push_back(std::move(frame));
    if (!first || station.sends) return true;
    if (now < station.noticed && station.was_free) {
        station.plan = now;  // it does not know yet that the channel is busy
        return true;
    }
    const bool is_free = now >= station.busy_until && now >= station.base;
    if (!is_free && station.count == 0) draw(station);
    plan(station, now);
    return true;
}

std::vector<Frame> Dcf::set_away(std::size_t number, bool away) {
    outlook_.reset();
    Station& station = stations_[number];
    station.away = away;
    std::vector<Frame> lost;
    if (!away) return lost;
    const std::size_t kept = station.sends ? 1 : 0;
    lost.assign(station.queue.begin() + static_cast<std::ptrdiff_t>(kept), station.queue.end());
    station.queue.resize(kept);
    station.ack_due = kNever;
    if (kept == 0) {
        station.plan = kNever;
        station.attempts = 0;
        station.window = phy_.first_window();
    }
    return lost;
}

void Dcf::send(std::size_t number, Time now) {
    Station& station = stations_[number];
    const Frame& frame = station.queue.front();
    station.plan = kNever;
    station.sends = true;
    station.count = 0;
    ++station.attempts;
    if (station.attempts > 1) ++station.counts.again;
    Transmission sent;
    sent.station = number;
    sent.start = now;
    sent.rate = &rate_for(number, frame.hop_to);
    sent.octets = kFrameOctets + frame.octets.size();
    sent.end = now + phy_.air_time(sent.octets, *sent.rate);
    sent.hop_to = frame.hop_to;
    sent.attempt = station.attempts;
    sent.reserved = sent.end;
    if (frame.hop_to != kEveryStation)
        sent.reserved += phy_.sifs() + phy_.air_time(kAckOctets, phy_.ack_rate(*sent.rate));
    put_on_air(std::move(sent));
}

void Dcf::acknowledge(std::size_t number, Time now) {
    Station& station = stations_[number];
    station.ack_due = kNever;
    for (const Transmission& one : medium_.on_air())
        if (!one.over && one.station == number) return;  // it sends a frame of its own
    ++station.counts.acks;
    Transmission sent;
    sent.station = number;
    sent.start = now;
    sent.rate = station.ack_rate;
    sent.octets = kAckOctets;
    sent.end = now + phy_.air_time(kAckOctets, *sent.rate);
    sent.acknowledges = true;
    sent.hop_to = station.ack_for;
    sent.attempt = station.ack_attempt;
    sent.reserved = sent.end;
    // Whoever waits for it learns at its end what became of it.
    stations_[station.ack_for].give_up = kNever;
    put_on_air(std::move(sent));
}

/// The channel as `station` finds it when a frame ends.
void Dcf::heard(const Transmission& sent, std::size_t number, Fate fate) {
    Station& station = stations_[number];
    if (fate == Fate::Sending) return;
    const bool sensed = sent.dbm[number] >= settings_.carrier_sense;
    if (fate != Fate::Read && !sensed) return;
    station.unread = fate != Fate::Read;
    // The header reserves the channel for the acknowledgement.
    if (fate == Fate::Read && sent.hop_to != number) return found_busy(station, sent.end, sent.reserved);
    if (!sensed || (station.plan != kNever && station.plan <= sent.end)) return;
    rebase(station, 0);
    plan(station, sent.end);
}

void Dcf::meant_for(const Transmission& sent, const Frame* frame, std::size_t number, Fate fate) {
    Station& station = stations_[number];
    user_.became(sent, number, fate);
    station.counts.losses.count(fate);
    if (fate != Fate::Read) return;
    if (sent.acknowledges) return;
    ++station.counts.read;
    if (sent.hop_to == number) {
        station.ack_due = sent.end + phy_.sifs();
        station.ack_for = sent.station;
        station.ack_attempt = sent.attempt;
        station.ack_rate = &phy_.ack_rate(*sent.rate);
        // Nothing of its own comes before that.
        found_busy(station, sent.end, sent.reserved);
    }
    std::uint64_t& last = station.last[sent.station];
    if (last == frame->number + 1) {
        ++station.counts.twice;
        return;
    }
    last = frame->number + 1;
    user_.received(number, *frame, sent);
}

void Dcf::ended(std::size_t on_air) {
    medium_.on_air()[on_air].over = true;
    const Transmission sent = medium_.on_air()[on_air];
    if (sent.station == kInterference) return burst_ended(sent.end, settings_.burst_power);
    const bool to_all = sent.hop_to == kEveryStation;
    std::optional<Frame> frame;
    if (!sent.acknowledges) frame = stations_[sent.station].queue.front();
    bool acknowledged = false;
    for (std::size_t s = 0; s < stations_.size(); ++s) {
        if (s == sent.station) continue;
        const Fate fate = stations_[s].away ? Fate::Away : medium_.judge(sent, s, stations_[s].noise);
        heard(sent, s, fate);
        if (!to_all && sent.hop_to != s) continue;
        if (sent.acknowledges) acknowledged = fate == Fate::Read;
        meant_for(sent, frame ? &*frame : nullptr, s, fate);
    }
    medium_.forget();
    Station& sender = stations_[sent.station];
    if (sent.acknowledges) {
        rebase(sender, 0);
        plan(sender, sent.end);
        if (acknowledged)
            succeeded(sent.hop_to, sent.end);
        else
            failed(sent.hop_to, sent.end);
    } else if (to_all) {
        succeeded(sent.station, sent.end);
    } else {
        sender.give_up = sent.end + phy_.ack_wait();
    }
}

void Dcf::next_frame(Station& station, Time now) {
    station.sends = false;
    draw(station);
    rebase(station, now);
    plan(station, now);
}

void Dcf::succeeded(std::size_t number, Time now) {
    Station& station = stations_[number];
    station.queue.pop_front();
    station.attempts = 0;
    station.window = phy_.first_window();
    station.unread = false;
    next_frame(station, now);
}

void Dcf::failed(std::size_t number, Time now) {
    Station& station = stations_[number];
    station.give_up = kNever;
    if (station.away || station.attempts >= settings_.attempts) {
        ++station.counts.dropped;
        user_.dropped(number, station.queue.front(), now);
        station.queue.pop_front();
        station.attempts = 0;
        station.window = phy_.first_window();
    } else {
        station.window = std::min(2 * station.window + 1, settings_.longest_window);
    }
    next_frame(station, now);
}

const Dcf::Outlook& Dcf::outlook() const {
    if (outlook_) return *outlook_;
    Outlook all{next_burst_, kNever};
    for (const Transmission& one : medium_.on_air()) {
        if (one.over) continue;
        all.next = std::min(all.next, one.end);
        if (one.station != kInterference) all.end = std::min(all.end, one.end);
    }
    Time acts = kNever;
    for (const Station& one : stations_)
        acts = std::min({acts, one.ack_due, one.give_up, one.plan});
    all.next = std::min(all.next, acts);
    // Whatever else happens may be followed by a frame, which takes its time.
    all.end = std::min(all.end, cosim::later(acts, phy_.shortest_packet()));
    return outlook_.emplace(all);
}

/// At one time: ends first, then acknowledgements, then who waits for one, then who sends.
void Dcf::step() {
    const Time now = next();
    outlook_.reset();
    for (std::size_t i = 0; i < medium_.on_air().size(); ++i) {
        const Transmission& one = medium_.on_air()[i];
        if (!one.over && one.end == now) return ended(i);
    }
    for (std::size_t s = 0; s < stations_.size(); ++s)
        if (stations_[s].ack_due == now) return acknowledge(s, now);
    if (next_burst_ == now) return burst(now);
    for (std::size_t s = 0; s < stations_.size(); ++s)
        if (stations_[s].give_up == now) return failed(s, now);
    for (std::size_t s = 0; s < stations_.size(); ++s)
        if (stations_[s].plan == now) return send(s, now);
}

}  // namespace puckloop::wifi
