// The sending side: window, congestion control, retransmission.

#include "linuxboard/shim/network/sequence.h"
#include "linuxboard/shim/network/tcp_connection.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;
using protocols::kAck;
using protocols::kFin;
using protocols::kPsh;
using protocols::kSyn;

namespace {
constexpr Time kShortestTimeout = 200 * cosim::kMillisecond;  // TCP_RTO_MIN
constexpr Time kLongestTimeout = 120 * cosim::kSecond;        // TCP_RTO_MAX
constexpr int kAnswerAttempts = 5;                            // tcp_synack_retries
constexpr int kDataAttempts = 15, kOrphanAttempts = 8;        // tcp_retries2, tcp_orphan_retries
constexpr std::uint32_t kFirstSegments = 10;                  // TCP_INIT_CWND, RFC 6928
constexpr int kDuplicatesOfLoss = 3;
constexpr Time kLongestCork = 200 * cosim::kMillisecond;  // tcp(7), TCP_CORK
}  // namespace

bool TcpConnection::fin_sent() const {
    return closing_ && after(highest_, data_end());
}

std::size_t TcpConnection::in_flight_data() const {
    if (!after(next_, data_begin_)) return 0;
    return std::min<std::size_t>(next_ - data_begin_, out_data_.size());
}

TcpConnection::Segment TcpConnection::bare() const {
    Segment segment;
    segment.from_port = local_.port;
    segment.to_port = peer_.port;
    segment.acknowledged = expected_;
    return segment;
}

/// What the peer may send; its right edge never goes back.
std::uint16_t TcpConnection::window() {
    const std::size_t room = settings_.receive_buffer - std::min(settings_.receive_buffer, in_.size());
    const std::uint32_t known = after(advertised_, expected_) ? advertised_ - expected_ : 0;
    // Opening it by less than a segment is not worth a word.
    const bool opens = room >= known + std::min(segment_, settings_.receive_buffer / 2);
    const auto offered = std::min<std::uint32_t>(opens ? static_cast<std::uint32_t>(room) : known, 0xffff);
    advertised_ = expected_ + offered;
    return static_cast<std::uint16_t>(offered);
}

void TcpConnection::send_syn(bool answer) {
    Segment syn = bare();
    syn.sequence = first_;
    syn.flags = static_cast<protocols::Octet>(answer ? kSyn | kAck : kSyn);
    if (!answer) syn.acknowledged = 0;
    syn.window = window();
    syn.most = static_cast<std::uint16_t>(settings_.most_segment);
    if (next_ != first_) ++counts_.retransmitted;
    next_ = highest_ = first_ + 1;
    ++counts_.sent;
    out_.push_back(syn);
}

void TcpConnection::send_acknowledgement() {
    Segment segment = bare();
    segment.sequence = next_;
    segment.flags = kAck;
    segment.window = window();
    acknowledge_now_ = false;
    acknowledge_at_ = kNever;
    unanswered_ = 0;
    ++counts_.sent;
    out_.push_back(segment);
}

void TcpConnection::send_segment(std::uint32_t sequence, std::size_t length, bool fin, Time now) {
    Segment segment = bare();
    segment.sequence = sequence;
    segment.data = out_data_.substr(sequence - data_begin_, length);
    segment.flags = kAck;
    if (length > 0 && sequence + length == data_end()) segment.flags |= kPsh;
    if (fin) segment.flags |= kFin;
    segment.window = window();
    acknowledge_now_ = false;
    acknowledge_at_ = kNever;
    unanswered_ = 0;
    const std::uint32_t end = sequence + segment.length();
    const bool again = before(sequence, highest_);
    ++counts_.sent;
    if (again) {
        ++counts_.retransmitted;
    } else {
        counts_.octets_sent += length;
        if (!timing_) {  // Karn: never one that is sent again
            timing_ = true;
            timed_ = end;
            timed_at_ = now;
        }
    }
    if (after(end, highest_)) highest_ = end;
    if (retransmit_at_ == kNever) {
        if (!again) progress_at_ = now;
        await_acknowledgement(now);
    }
    out_.push_back(std::move(segment));
}

void TcpConnection::send(Time now) {
    const bool may_send = synchronised() && state_ != State::TimeWait && state_ != State::FinWait2;
    while (may_send) {
        if (congestion_ == 0) congestion_ = kFirstSegments * static_cast<std::uint32_t>(segment_);
        const std::uint32_t allowed = std::min(congestion_, peer_window_);
        const std::uint32_t usable = allowed > flight() ? allowed - flight() : 0;
        const std::size_t waiting = out_data_.size() - in_flight_data();
        const std::size_t length = std::min({waiting, segment_, static_cast<std::size_t>(usable)});
        const bool all = length == waiting;
        const bool fin = closing_ && all && next_ + length == data_end();
        if (length == 0 && !(fin && (usable > 0 || flight() == 0))) break;
        const bool again = before(next_, highest_);
        const bool worth = length == segment_ || again || fin ||
                           (all && (settings_.no_delay || flight() == 0)) ||
                           (length > 0 && 2 * length >= widest_window_);
        const bool held = (settings_.cork || more_) && length < segment_ && !again && !fin;
        if (held && uncork_at_ == kNever) uncork_at_ = now + kLongestCork;
        if (!worth || (held && now < uncork_at_)) break;
        uncork_at_ = kNever;
        send_segment(next_, length, fin, now);
        next_ += static_cast<std::uint32_t>(length) + (fin ? 1 : 0);
        if (fin) break;
    }
    if (acknowledge_now_) send_acknowledgement();
    // The peer has no room: it is asked for it, as its word that it has some again may be lost.
    const bool stuck = may_send && flight() == 0 && unsent() > 0 && uncork_at_ == kNever;
    if (!stuck) {
        probe_at_ = kNever;
        probes_ = 0;
    } else if (probe_at_ == kNever) {
        stuck_since_ = now;
        probe_at_ = now + timeout_;
    }
}

void TcpConnection::probe(Time now) {
    probe_at_ = kNever;
    if (unsent() == 0) return;
    if (outlasted(stuck_since_, now) || ++unanswered_probes_ > kDataAttempts) return end(ETIMEDOUT);
    ++probes_;
    ask_peer();
    probe_at_ = now + std::min(timeout_ << std::min(probes_, 9), kLongestTimeout);
    if (settings_.user_timeout > 0)
        probe_at_ = std::min(probe_at_, std::max(stuck_since_ + settings_.user_timeout, now + 1));
}

/// An old number: it has to be answered.
void TcpConnection::ask_peer() {
    Segment segment = bare();
    segment.sequence = next_ - 1;
    segment.flags = kAck;
    segment.window = window();
    ++counts_.sent;
    out_.push_back(segment);
}

void TcpConnection::await_acknowledgement(Time now) {
    retransmit_at_ = now + timeout_;
    if (settings_.user_timeout > 0)
        retransmit_at_ = std::min(retransmit_at_, std::max(progress_at_ + settings_.user_timeout, now + 1));
}

/// What began at `since` has lasted as long as TCP_USER_TIMEOUT lets it.
bool TcpConnection::outlasted(Time since, Time now) const {
    return settings_.user_timeout > 0 && now - since >= settings_.user_timeout;
}

void TcpConnection::send_first_again(Time now) {
    const std::size_t there = out_data_.size() - (unacknowledged_ - data_begin_);
    const std::size_t length = std::min(there, segment_);
    const bool fin = fin_sent() && length == there;
    if (length > 0 || fin) send_segment(unacknowledged_, length, fin, now);
    timing_ = false;
}

void TcpConnection::receive_acknowledgement(const Segment& segment, Time now) {
    const std::uint32_t number = segment.acknowledged;
    if (after(number, highest_)) {  // of what was never sent
        acknowledge_now_ = true;
        return;
    }
    const bool newer = before(window_sequence_, segment.sequence) ||
                       (window_sequence_ == segment.sequence && !before(number, window_acknowledged_));
    const bool same_window = segment.window == peer_window_;
    if (newer) {
        if (peer_window_ < segment.window) stir();
        peer_window_ = segment.window;
        widest_window_ = std::max(widest_window_, peer_window_);
        window_sequence_ = segment.sequence;
        window_acknowledged_ = number;
    }
    if (after(number, unacknowledged_)) return acknowledged(number - unacknowledged_, number, now);
    const bool bare_one = segment.data.empty() && (segment.flags & kFin) == 0;
    if (number == unacknowledged_ && bare_one && same_window && flight() > 0) duplicate_acknowledgement(now);
}

void TcpConnection::duplicate_acknowledgement(Time now) {
    ++duplicates_;
    const auto segment = static_cast<std::uint32_t>(segment_);
    if (recovering_) {
        congestion_ += segment;
        return;
    }
    // Not for what was lost already when the last loss was found (RFC 6582, 3.2).
    if (duplicates_ != kDuplicatesOfLoss || !after(unacknowledged_, recover_)) return;
    ++counts_.fast_retransmits;
    threshold_ = std::max(flight() / 2, 2 * segment);
    recover_ = highest_;
    recovering_ = true;
    congestion_ = threshold_ + kDuplicatesOfLoss * segment;
    send_first_again(now);
    await_acknowledgement(now);
}

void TcpConnection::acknowledged(std::uint32_t octets, std::uint32_t number, Time now) {
    if (timing_ && !before(number, timed_)) {
        timing_ = false;
        sample(now - timed_at_);
    }
    const std::size_t data =
        after(number, data_begin_) ? std::min<std::size_t>(number - data_begin_, out_data_.size()) : 0;
    const bool fin = fin_sent() && after(number, data_end());
    out_data_.erase(0, data);
    data_begin_ += static_cast<std::uint32_t>(data);
    unacknowledged_ = number;
    if (before(next_, number)) next_ = number;
    const auto segment = static_cast<std::uint32_t>(segment_);
    if (congestion_ == 0) congestion_ = kFirstSegments * segment;
    if (recovering_ && !before(number, recover_)) {
        recovering_ = false;
        congestion_ = std::min(threshold_, std::max(flight(), segment) + segment);
    } else if (recovering_) {  // the next hole
        send_first_again(now);
        congestion_ -= std::min(congestion_ - segment, octets);
        if (octets >= segment) congestion_ += segment;
    } else if (data > 0) {
        congestion_ += congestion_ < threshold_ ? std::min(octets, segment)
                                                : std::max(1u, segment * segment / congestion_);
    }
    if (!recovering_) duplicates_ = 0;
    attempts_ = 0;
    if (measured_)
        timeout_ = std::clamp(smoothed_ + std::max(4 * variation_, kShortestTimeout), kShortestTimeout,
                              kLongestTimeout);
    progress_at_ = now;
    if (unacknowledged_ == highest_)
        retransmit_at_ = kNever;
    else
        await_acknowledgement(now);
    if (data > 0) stir();
    if (!fin) return;
    if (state_ == State::FinWait1)
        enter(State::FinWait2, now);
    else if (state_ == State::Closing)
        enter(State::TimeWait, now);
    else if (state_ == State::LastAck)
        end(0);
}

/// RFC 6298, 2.2 and 2.3; as in Linux the variation's part is at least the shortest time-out.
void TcpConnection::sample(Time round_trip) {
    if (!measured_) {
        measured_ = true;
        smoothed_ = round_trip;
        variation_ = round_trip / 2;
        return;
    }
    variation_ += (std::abs(smoothed_ - round_trip) - variation_) / 4;
    smoothed_ += (round_trip - smoothed_) / 8;
}

void TcpConnection::timed_out(Time now) {
    retransmit_at_ = kNever;
    const int most = state_ == State::SynSent       ? settings_.syn_attempts
                     : state_ == State::SynReceived ? kAnswerAttempts
                     : orphan_                      ? kOrphanAttempts
                                                    : kDataAttempts;
    const bool by_time = settings_.user_timeout > 0 && synchronised();
    if (outlasted(progress_at_, now) || (++attempts_ > most && !by_time)) return end(ETIMEDOUT);
    ++counts_.timeouts;
    timing_ = false;
    timeout_ = std::min(2 * timeout_, kLongestTimeout);
    if (!synchronised()) {
        send_syn(state_ == State::SynReceived);
        await_acknowledgement(now);
        return;
    }
    const auto segment = static_cast<std::uint32_t>(segment_);
    threshold_ = std::max(flight() / 2, 2 * segment);
    congestion_ = segment;
    recovering_ = false;
    duplicates_ = 0;
    recover_ = highest_;
    next_ = unacknowledged_;
    send(now);
    // A peer without room is asked again all the same.
    if (retransmit_at_ == kNever) {
        send_first_again(now);
        if (retransmit_at_ == kNever) await_acknowledgement(now);
    }
}

std::size_t TcpConnection::write(std::string_view data, Time now, bool more) {
    const std::size_t taken = std::min(data.size(), room());
    more_ = more;
    out_data_.append(data.substr(0, taken));
    if (taken > 0) send(now);
    return taken;
}

void TcpConnection::set_cork(bool on, Time now) {
    settings_.cork = on;
    if (!on) more_ = false;
    if (!on && synchronised()) send(now);
}

void TcpConnection::set_no_delay(bool on, Time now) {
    settings_.no_delay = on;
    if (on && synchronised()) send(now);
}

}  // namespace puckloop::linuxboard
