// States and the receiving side; tcp_sending.cpp has the other.

#include "linuxboard/shim/network/tcp_connection.h"

#include "linuxboard/shim/network/sequence.h"

#include <algorithm>
#include <cerrno>
#include <utility>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;
using protocols::kAck;
using protocols::kFin;
using protocols::kRst;
using protocols::kSyn;

namespace {
constexpr Time kFirstTimeout = cosim::kSecond;                      // RFC 6298, 2.1; TCP_TIMEOUT_INIT
constexpr Time kLinger = 60 * cosim::kSecond;                       // TCP_TIMEWAIT_LEN, tcp_fin_timeout
constexpr Time kDelayedAcknowledgement = 40 * cosim::kMillisecond;  // TCP_DELACK_MIN
constexpr int kSegmentsPerAcknowledgement = 2;
}  // namespace

TcpConnection::TcpConnection(Endpoint local, Endpoint peer, std::uint32_t first_sequence,
                             const Settings& settings)
    : local_(local),
      peer_(peer),
      settings_(settings),
      first_(first_sequence),
      unacknowledged_(first_sequence),
      next_(first_sequence),
      highest_(first_sequence),
      data_begin_(first_sequence + 1),
      recover_(first_sequence),
      timeout_(kFirstTimeout) {}

void TcpConnection::enter(State state, Time now) {
    state_ = state;
    stir();
    if (state == State::TimeWait || (state == State::FinWait2 && orphan_)) leave_at_ = now + kLinger;
    if (state == State::TimeWait) retransmit_at_ = probe_at_ = acknowledge_at_ = kNever;
    watch_peer(now);
}

void TcpConnection::end(int error) {
    state_ = State::Closed;
    if (error != 0) error_ = error;
    retransmit_at_ = probe_at_ = acknowledge_at_ = leave_at_ = keep_at_ = uncork_at_ = kNever;
    acknowledge_now_ = false;
    stir();
}

void TcpConnection::fail(int error) {
    if (state_ != State::Closed) end(error);
}

void TcpConnection::connect(Time now) {
    state_ = State::SynSent;
    send_syn(false);
    progress_at_ = now;
    await_acknowledgement(now);
    timing_ = true;
    timed_ = next_;
    timed_at_ = now;
}

void TcpConnection::answer(const Segment& syn, Time now) {
    state_ = State::SynReceived;
    peer_first_ = syn.sequence;
    expected_ = advertised_ = syn.sequence + 1;
    if (syn.most != 0) segment_ = std::min<std::size_t>(syn.most, settings_.most_segment);
    peer_window_ = widest_window_ = syn.window;
    window_sequence_ = syn.sequence;
    send_syn(true);
    heard_at_ = progress_at_ = now;
    await_acknowledgement(now);
    timing_ = true;
    timed_ = next_;
    timed_at_ = now;
}

void TcpConnection::reset_peer(std::uint32_t sequence) {
    Segment reset = bare();
    reset.sequence = sequence;
    reset.flags = kRst | kAck;
    out_.push_back(reset);
    ++counts_.sent;
}

bool TcpConnection::acceptable(const Segment& segment) const {
    const std::uint32_t edge = after(advertised_, expected_) ? advertised_ : expected_;
    const std::uint32_t room = edge - expected_, length = segment.length();
    if (length == 0 && room == 0) return segment.sequence == expected_;
    const auto inside = [&](std::uint32_t number) { return number - expected_ < room; };
    if (length == 0) return inside(segment.sequence) || segment.sequence == expected_;
    return room > 0 && (inside(segment.sequence) || inside(segment.sequence + length - 1));
}

void TcpConnection::receive_in_syn_sent(const Segment& segment, Time now) {
    const bool acknowledges = (segment.flags & kAck) != 0;
    if (acknowledges && segment.acknowledged != next_) {
        if ((segment.flags & kRst) == 0) {
            Segment reset = bare();
            reset.sequence = segment.acknowledged;
            reset.flags = kRst;
            out_.push_back(reset);
        }
        return;
    }
    if ((segment.flags & kRst) != 0) {
        if (acknowledges) end(ECONNREFUSED);
        return;
    }
    if ((segment.flags & kSyn) == 0) return;
    if (!acknowledges) {  // both ends open at once, or it is the same one
        timing_ = false;
        return answer(segment, now);
    }
    peer_first_ = segment.sequence;
    expected_ = advertised_ = segment.sequence + 1;
    if (segment.most != 0) segment_ = std::min<std::size_t>(segment.most, settings_.most_segment);
    peer_window_ = widest_window_ = segment.window;
    window_sequence_ = segment.sequence;
    window_acknowledged_ = segment.acknowledged;
    enter(State::Established, now);
    acknowledged(1, segment.acknowledged, now);
    acknowledge_now_ = true;
    send(now);
}

void TcpConnection::receive(const Segment& segment, Time now) {
    ++counts_.received;
    if (state_ == State::Closed) return;
    heard_at_ = now;
    keep_probes_ = unanswered_probes_ = 0;
    if (state_ == State::SynSent) return receive_in_syn_sent(segment, now);
    const bool opened_at_once = state_ == State::SynReceived && segment.sequence == peer_first_ &&
                                segment.flags == (kSyn | kAck) && segment.acknowledged == next_;
    if (opened_at_once) {
        enter(State::Established, now);
        receive_acknowledgement(segment, now);
        acknowledge_now_ = true;
        return send(now);
    }
    if (!acceptable(segment)) {
        if ((segment.flags & kRst) != 0) return;
        // The SYN+ACK, or what came before, was lost or is repeated.
        if (state_ == State::TimeWait && (segment.flags & kFin) != 0) leave_at_ = now + kLinger;
        send_acknowledgement();
        return;
    }
    if ((segment.flags & kRst) != 0) {
        if (state_ == State::TimeWait) return;  // RFC 1337
        end(state_ == State::SynReceived ? ECONNREFUSED : state_ == State::CloseWait ? EPIPE : ECONNRESET);
        return;
    }
    if ((segment.flags & kSyn) != 0) {
        send_acknowledgement();  // RFC 5961
        return;
    }
    if ((segment.flags & kAck) == 0) return;
    if (state_ == State::SynReceived) {
        if (segment.acknowledged != next_) return reset_peer(segment.acknowledged);
        enter(State::Established, now);
    }
    receive_acknowledgement(segment, now);
    if (state_ == State::Closed) return;
    if (!segment.data.empty() || (segment.flags & kFin) != 0) receive_data(segment, now);
    if (state_ != State::Closed) send(now);
}

void TcpConnection::receive_data(Segment segment, Time now) {
    if (!segment.data.empty() && (orphan_ || state_ == State::TimeWait)) {
        if (state_ == State::TimeWait) return send_acknowledgement();
        // Nobody will ever read it.
        reset_peer(next_);
        return end(0);
    }
    if ((segment.flags & kFin) != 0) {
        fin_known_ = true;
        fin_at_ = segment.sequence + static_cast<std::uint32_t>(segment.data.size());
    }
    if (peer_done_) {
        acknowledge_now_ = true;
        return;
    }
    if (before(segment.sequence, expected_)) {  // partly or all repeated
        const std::uint32_t old = expected_ - segment.sequence;
        segment.data.erase(0, std::min<std::size_t>(old, segment.data.size()));
        segment.sequence = expected_;
        acknowledge_now_ = acknowledge_now_ || segment.data.empty();
    }
    const std::uint32_t room = advertised_ - segment.sequence;
    if (segment.data.size() > room) segment.data.resize(room);
    if (!segment.data.empty() && segment.sequence != expected_) {
        auto& kept = early_[segment.sequence - peer_first_];
        if (kept.size() < segment.data.size()) kept = std::move(segment.data);
        acknowledge_now_ = true;
    } else if (!segment.data.empty()) {
        const bool hole = !early_.empty();
        in_ += segment.data;
        expected_ += static_cast<std::uint32_t>(segment.data.size());
        counts_.octets_received += segment.data.size();
        while (!early_.empty()) {
            const auto first = early_.begin();
            const std::uint32_t begin = first->first + peer_first_;
            if (after(begin, expected_)) break;
            const std::uint32_t old = expected_ - begin;
            if (old < first->second.size()) {
                counts_.octets_received += first->second.size() - old;
                in_.append(first->second, old);
                expected_ = begin + static_cast<std::uint32_t>(first->second.size());
            }
            early_.erase(first);
        }
        stir();
        ++unanswered_;
        if (hole || unanswered_ >= kSegmentsPerAcknowledgement) acknowledge_now_ = true;
        if (acknowledge_at_ == kNever) acknowledge_at_ = now + kDelayedAcknowledgement;
    }
    if (fin_known_ && expected_ == fin_at_) receive_fin(now);
}

void TcpConnection::receive_fin(Time now) {
    peer_done_ = true;
    ++expected_;
    acknowledge_now_ = true;
    switch (state_) {
    case State::Established:
        enter(State::CloseWait, now);
        break;
    case State::FinWait1:  // its acknowledgement of our FIN, if it came with it, has been seen
        enter(State::Closing, now);
        break;
    case State::FinWait2:
        enter(State::TimeWait, now);
        break;
    default:
        break;
    }
}

std::string TcpConnection::read(std::size_t most, bool peek, Time now) {
    std::string data = in_.substr(0, most);
    if (peek) return data;
    in_.erase(0, data.size());
    // The other side hears of the room once it is worth a segment or two (RFC 9293, 3.8.6.2.2).
    const std::size_t room = settings_.receive_buffer - std::min(settings_.receive_buffer, in_.size());
    const std::uint32_t known = after(advertised_, expected_) ? advertised_ - expected_ : 0;
    const std::size_t worth = std::min(2 * segment_, settings_.receive_buffer / 2);
    if (synchronised() && state_ != State::TimeWait && !peer_done_ && room >= known + worth) {
        acknowledge_now_ = true;
        send(now);
    }
    return data;
}

void TcpConnection::shut_read(Time /*now*/) {
    read_shut_ = true;
    stir();
}

void TcpConnection::shut_write(Time now) {
    if (closing_) return;
    switch (state_) {
    case State::SynReceived:
    case State::Established:
        closing_ = true;
        enter(State::FinWait1, now);
        break;
    case State::CloseWait:
        closing_ = true;
        enter(State::LastAck, now);
        break;
    case State::SynSent:
        return end(0);
    default:
        return;
    }
    send(now);
}

void TcpConnection::close(Time now) {
    if (state_ == State::Closed || orphan_) return;
    orphan_ = true;
    if (!in_.empty()) return abort(now);
    shut_write(now);
    if (state_ == State::FinWait2) leave_at_ = now + kLinger;
}

void TcpConnection::abort(Time /*now*/) {
    if (state_ == State::Closed) return;
    if (state_ != State::SynSent && state_ != State::TimeWait) reset_peer(next_);
    end(0);
}

void TcpConnection::advance(Time now) {
    if (leave_at_ <= now) return end(0);
    if (acknowledge_at_ <= now) {
        acknowledge_now_ = true;
        send(now);
    }
    if (uncork_at_ <= now) {
        send(now);
        uncork_at_ = kNever;
    }
    if (retransmit_at_ <= now) timed_out(now);
    if (probe_at_ <= now) probe(now);
    if (keep_at_ <= now) check_peer(now);
}

void TcpConnection::watch_peer(Time now) {
    const bool watched = settings_.keep_alive && synchronised() && state_ != State::TimeWait && !orphan_;
    keep_at_ = watched ? std::max(now, heard_at_ + settings_.keep_idle) : kNever;
}

/// Keep-alive (RFC 1122, 4.2.3.6), as tcp_keepalive_timer(): what is on its way to the peer asks it as well.
void TcpConnection::check_peer(Time now) {
    if (orphan_) keep_at_ = kNever;
    if (keep_at_ == kNever) return;
    if (flight() > 0 || unsent() > 0) {
        keep_at_ = now + settings_.keep_idle;
        return;
    }
    const Time silent = now - heard_at_;
    if (silent < settings_.keep_idle) return watch_peer(now);
    const bool over = settings_.user_timeout > 0 ? keep_probes_ > 0 && silent >= settings_.user_timeout
                                                 : keep_probes_ >= settings_.keep_count;
    if (over) {
        reset_peer(next_);
        return end(ETIMEDOUT);
    }
    ++keep_probes_;
    ask_peer();
    keep_at_ = now + settings_.keep_interval;
}

Time TcpConnection::next_event() const {
    return std::min({leave_at_, acknowledge_at_, retransmit_at_, probe_at_, keep_at_, uncork_at_});
}

}  // namespace puckloop::linuxboard
