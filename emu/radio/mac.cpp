#include "emu/radio/mac.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::radio {

namespace {

using cosim::Time;
using protocols::MeshFrame;

// IEEE 802.15.4-2006, tables 85 and 86.
constexpr int kMinExponent = 3, kMaxExponent = 5, kMostBackoffs = 4;
constexpr Time kBackoffUnit = 20 * kSymbol;  // aUnitBackoffPeriod
constexpr Time kAssessment = 8 * kSymbol;    // clear channel assessment
constexpr std::size_t kAckOctets = 5;
constexpr Time kLongestFrame = air_time(127);

}  // namespace

Mac::Mac(Medium& medium, Agenda& agenda, const std::vector<std::string>& names, std::uint64_t seed,
         AirFaults& faults, MacUser& user)
    : medium_(medium), agenda_(agenda), faults_(faults), user_(user) {
    for (const std::string& name : names)
        stations_.emplace_back(RandomStream(seed, "radio/backoff/" + name),
                               RandomStream(seed, "radio/noise/" + name));
}

std::vector<std::uint64_t> Mac::set(std::size_t station, const RadioSettings& settings) {
    Station& it = stations_[station];
    const RadioSettings before = it.settings;
    it.settings = settings;
    if (before.on && settings.on && before.channel == settings.channel && before.pan == settings.pan &&
        before.address == settings.address)
        return {};
    it.counts.dropped += it.queue.size();
    it.last_heard.clear();
    ++it.turn;
    std::vector<std::uint64_t> dropped;
    for (const Job& job : it.queue)
        dropped.push_back(job.token);
    it.queue.clear();
    return dropped;
}

void Mac::submit(std::size_t station, const MeshFrame& frame, std::uint64_t token, Time now) {
    Station& it = stations_[station];
    Job job{frame, token};
    job.frame.pan = it.settings.pan;
    job.frame.hop_from = it.settings.address;
    job.frame.asks_ack = frame.hop_to != protocols::kXBeeBroadcast && it.settings.mac_retries > 0;
    it.queue.push_back(std::move(job));
    if (it.queue.size() == 1) attempt(station, now);
}

void Mac::attempt(std::size_t station, Time now) {
    Station& it = stations_[station];
    it.backoffs = 0;
    it.exponent = kMinExponent;
    if (it.queue.front().attempts == 0) it.queue.front().frame.mac_sequence = it.sequence++;
    back_off(station, now);
}

void Mac::back_off(std::size_t station, Time now) {
    Station& it = stations_[station];
    const auto slots = static_cast<Time>(it.backoff.below(std::uint64_t{1} << it.exponent));
    const Time look = it.settings.cca != 0 ? kAssessment : 0;
    agenda_.add({now + slots * kBackoffUnit + look, EventKind::Access, station, ++it.turn});
}

Time Mac::earliest_end(const Event& event) {
    return event.kind == EventKind::Access ? event.at + kTurnaround + air_time(protocols::kMeshOverhead)
                                           : event.at;
}

void Mac::happen(const Event& event) {
    const bool current = event.token == stations_[event.station].turn;
    switch (event.kind) {
    case EventKind::Access:
        if (current) access(event.station, event.at);
        break;
    case EventKind::NoAccess:
        if (current) failed_attempt(event.station, true, event.at);
        break;
    case EventKind::AckMissing:
        if (current) failed_attempt(event.station, false, event.at);
        break;
    case EventKind::FrameEnd:
        frame_end(event.token, event.at);
        break;
    case EventKind::AckEnd:
        ack_end(event.token, event.at);
        break;
    default:
        break;
    }
}

void Mac::access(std::size_t station, Time now) {
    Station& it = stations_[station];
    const Time start = now + kTurnaround;
    const Time end = start + air_time(protocols::kMeshOverhead + it.queue.front().frame.data.size());
    // An acknowledgement of its own goes first.
    if (const Time own = medium_.own_until(station, now, end); own != 0) {
        agenda_.add({own, EventKind::Access, station, ++it.turn});
        return;
    }
    if (it.settings.cca != 0 && finds_busy(station, now)) {
        if (++it.backoffs > kMostBackoffs) {
            ++it.counts.channel_busy;
            // As late as the shortest frame would have ended: nothing that a frame leads to comes earlier.
            agenda_.add(
                {start + air_time(protocols::kMeshOverhead), EventKind::NoAccess, station, ++it.turn});
            return;
        }
        it.exponent = std::min(it.exponent + 1, kMaxExponent);
        back_off(station, now);
        return;
    }
    transmit(station, start);
}

void Mac::transmit(std::size_t station, Time start) {
    Station& it = stations_[station];
    const Job& job = it.queue.front();
    Flying flying;
    flying.frame = job.frame;
    flying.turn = ++it.turn;
    flying.transmission = {next_id_++,
                           station,
                           it.settings.channel,
                           static_cast<double>(it.settings.dbm),
                           start,
                           start + air_time(protocols::kMeshOverhead + job.frame.data.size()),
                           0};
    ++it.counts.frames;
    medium_.forget_before(start - 2 * kLongestFrame);
    medium_.add(flying.transmission);
    agenda_.add({flying.transmission.end, EventKind::FrameEnd, station, flying.transmission.id});
    flying_.emplace(flying.transmission.id, std::move(flying));
}

bool Mac::finds_busy(std::size_t station, Time now) {
    const Station& it = stations_[station];
    if (!faults_.empty()) faults_.advance(medium_, now + 1);
    const Transmission* const other =
        medium_.busy(station, it.settings.channel, -static_cast<double>(it.settings.cca), now);
    if (other != nullptr && other->foreign()) faults_.kept_waiting(*other, station, now);
    return other != nullptr;
}

bool Mac::reads(std::size_t station, const Transmission& transmission, std::optional<MeshFrame>& frame) {
    Station& it = stations_[station];
    if (!faults_.empty()) faults_.advance(medium_, transmission.end);
    const Transmission* foreign = nullptr;
    const Fate fate = medium_.fate(transmission, station, &foreign);
    it.counts.losses.count(fate);
    if (fate == Fate::Collision && foreign != nullptr) faults_.spoilt(*foreign, transmission, station);
    if (fate != Fate::Read) return false;
    const double loss = medium_.propagation().frame_loss(medium_.received_dbm(transmission, station));
    const bool clear = it.noise.uniform() >= loss;
    if (clear && (faults_.empty() || faults_.read(transmission, frame, station))) return true;
    it.counts.losses.count(Fate::Noise);
    return false;
}

void Mac::frame_end(std::uint64_t id, Time now) {
    const auto node = flying_.extract(id);
    const Flying& flying = node.mapped();
    const Transmission& sent = flying.transmission;
    const MeshFrame& frame = flying.frame;
    const bool to_all = frame.hop_to == protocols::kXBeeBroadcast;
    // Acknowledgements first, then what the frame causes: nobody sends in between.
    struct Reader {
        std::size_t station;
        std::optional<MeshFrame> frame;  ///< if a fault has changed what it reads
    };
    std::vector<Reader> readers;
    for (std::size_t s = 0; s < stations_.size(); ++s) {
        const RadioSettings& settings = stations_[s].settings;
        if (s == sent.station || !settings.on || settings.channel != sent.channel) continue;
        if (settings.pan != frame.pan || !(to_all || settings.address == frame.hop_to)) continue;
        std::optional<MeshFrame> as_read;
        if (!faults_.empty()) as_read = frame;
        if (!reads(s, sent, as_read)) continue;
        readers.push_back({s, std::move(as_read)});
        if (frame.asks_ack) acknowledge(s, flying, now);
    }
    Station& sender = stations_[sent.station];
    if (sender.turn == flying.turn) {
        if (frame.asks_ack)
            agenda_.add({now + kAckWait, EventKind::AckMissing, sent.station, flying.turn});
        else
            finish(sent.station, true, false, now);
    }
    for (const Reader& reader : readers) {
        const std::size_t s = reader.station;
        const MeshFrame& heard = reader.frame ? *reader.frame : frame;
        Station& it = stations_[s];
        ++it.counts.received;
        const auto [last, is_new] = it.last_heard.try_emplace(heard.hop_from, heard.mac_sequence);
        const bool again = !is_new && last->second == heard.mac_sequence;
        last->second = heard.mac_sequence;
        if (again)
            ++it.counts.duplicates;
        else
            user_.received(s, heard, {medium_.received_dbm(sent, s), sent.start, now});
    }
}

void Mac::acknowledge(std::size_t station, const Flying& flying, Time now) {
    Station& it = stations_[station];
    const Time start = now + kTurnaround;
    const Time end = start + air_time(kAckOctets);
    if (medium_.own_until(station, start, end) != 0) return;  // it is about to send a frame
    Flying ack;
    ack.transmission = {next_id_++, station, it.settings.channel,   static_cast<double>(it.settings.dbm),
                        start,      end,     flying.transmission.id};
    ack.frame.hop_to = flying.transmission.station;
    ack.turn = flying.turn;
    ++it.counts.acks;
    medium_.add(ack.transmission);
    agenda_.add({end, EventKind::AckEnd, station, ack.transmission.id});
    flying_.emplace(ack.transmission.id, std::move(ack));
}

void Mac::ack_end(std::uint64_t id, Time now) {
    const auto node = flying_.extract(id);
    const Flying& ack = node.mapped();
    const auto to = static_cast<std::size_t>(ack.frame.hop_to);
    const Station& it = stations_[to];
    if (!it.settings.on || it.settings.channel != ack.transmission.channel || it.turn != ack.turn) return;
    std::optional<MeshFrame> no_frame;
    if (reads(to, ack.transmission, no_frame)) finish(to, true, false, now);
}

void Mac::failed_attempt(std::size_t station, bool busy, Time now) {
    Station& it = stations_[station];
    Job& job = it.queue.front();
    if (job.attempts++ < it.settings.mac_retries && job.frame.hop_to != protocols::kXBeeBroadcast) {
        ++it.counts.retries;
        attempt(station, now);
        return;
    }
    ++it.counts.failures;
    finish(station, false, busy, now);
}

void Mac::finish(std::size_t station, bool delivered, bool busy, Time now) {
    Station& it = stations_[station];
    ++it.turn;
    const std::uint64_t token = it.queue.front().token;
    it.queue.pop_front();
    if (!it.queue.empty()) attempt(station, now);
    user_.sent(station, token, delivered, busy, now);
}

}  // namespace puckloop::radio
