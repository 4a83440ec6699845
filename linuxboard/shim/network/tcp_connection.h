#pragma once
// One end of a TCP connection: what a kernel keeps of it. Segments go in and out, time comes from outside.
// Sources: RFC 9293 (TCP), RFC 5681 and 6582 (congestion control, NewReno), RFC 6298 (retransmission timer),
// RFC 1122 (delayed acknowledgements, Nagle, silly windows); Linux 5.10 for the constants
// (include/net/tcp.h).
//
// Deviations: 1. No window scaling, time stamps, selective acknowledgements or ECN: a window is at most
// 65,535 octets. 2. No urgent data.

#include "cosim/core/time.h"
#include "protocols/network/ip_packet.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::linuxboard {

struct Endpoint {
    protocols::IpAddress address = 0;
    std::uint16_t port = 0;
    friend auto operator<=>(const Endpoint&, const Endpoint&) = default;
};

struct TcpCounts {
    std::uint64_t sent = 0, received = 0;                ///< segments
    std::uint64_t retransmitted = 0;                     ///< of the sent ones
    std::uint64_t timeouts = 0;                          ///< of the retransmission timer
    std::uint64_t fast_retransmits = 0;                  ///< begun by three duplicate acknowledgements
    std::uint64_t octets_sent = 0, octets_received = 0;  ///< of data, each once

    TcpCounts& operator+=(const TcpCounts& other) {
        sent += other.sent;
        received += other.received;
        retransmitted += other.retransmitted;
        timeouts += other.timeouts;
        fast_retransmits += other.fast_retransmits;
        octets_sent += other.octets_sent;
        octets_received += other.octets_received;
        return *this;
    }
};

class TcpConnection {
  public:
    enum class State {
        Closed,
        SynSent,
        SynReceived,
        Established,
        FinWait1,
        FinWait2,
        CloseWait,
        Closing,
        LastAck,
        TimeWait
    };
    static constexpr std::size_t kSegment = protocols::kMtu - protocols::kIpHeader - protocols::kTcpHeader;
    struct Settings {
        std::size_t send_buffer = 65'536;     ///< octets that wait or are on their way
        std::size_t receive_buffer = 65'535;  ///< 1 to 65,535
        bool no_delay = false;                ///< TCP_NODELAY
        bool cork = false;                    ///< TCP_CORK
        bool keep_alive = false;              ///< SO_KEEPALIVE
        cosim::Time keep_idle = 7200 * cosim::kSecond, keep_interval = 75 * cosim::kSecond;
        int keep_count = 9;                   ///< probes without an answer
        cosim::Time user_timeout = 0;         ///< of what is sent and not acknowledged; 0: by repetitions
        int syn_attempts = 6;                 ///< tcp_syn_retries
        std::size_t most_segment = kSegment;  ///< TCP_MAXSEG
    };
    TcpConnection(Endpoint local, Endpoint peer, std::uint32_t first_sequence, const Settings& settings);

    void connect(cosim::Time now);
    /// The other side's SYN.
    void answer(const protocols::TcpSegment& syn, cosim::Time now);
    void receive(const protocols::TcpSegment& segment, cosim::Time now);
    /// Octets taken, as many as there is room for. `more` follows soon (MSG_MORE).
    std::size_t write(std::string_view data, cosim::Time now, bool more = false);
    std::string read(std::size_t most, bool peek, cosim::Time now);
    void shut_write(cosim::Time now);
    void shut_read(cosim::Time now);
    /// Nobody has it any more: what was written still goes out, unless something was not read.
    void close(cosim::Time now);
    /// The other side is sent a reset.
    void abort(cosim::Time now);
    /// It is over, by an error that came from elsewhere.
    void fail(int error);
    void set_no_delay(bool on, cosim::Time now);
    void set_cork(bool on, cosim::Time now);
    Settings& settings() { return settings_; }
    /// Keep-alive was switched on or off, or its times were changed.
    void watch_peer(cosim::Time now);

    /// Timers due up to and including `now`.
    void advance(cosim::Time now);
    cosim::Time next_event() const;
    /// What goes to the network, in order.
    std::vector<protocols::TcpSegment> take_segments() { return std::exchange(out_, {}); }

    State state() const { return state_; }
    const Endpoint& local() const { return local_; }
    const Endpoint& peer() const { return peer_; }
    bool synchronised() const { return state_ > State::SynReceived; }
    std::size_t readable() const { return in_.size(); }
    /// Everything has been received, or the reading side is shut.
    bool at_end() const { return in_.empty() && (peer_done_ || read_shut_ || state_ == State::Closed); }
    bool peer_done() const { return peer_done_ || read_shut_; }
    bool write_done() const { return closing_; }
    std::size_t room() const {
        return out_data_.size() < settings_.send_buffer ? settings_.send_buffer - out_data_.size() : 0;
    }
    std::size_t unsent() const { return out_data_.size() - in_flight_data(); }
    std::size_t unacknowledged() const { return out_data_.size(); }
    /// errno of its end, 0: none; asked once.
    int take_error() { return std::exchange(error_, 0); }
    int error() const { return error_; }
    /// Counts what a program that waits for it could want to know.
    std::uint32_t activity() const { return activity_; }
    const TcpCounts& counts() const { return counts_; }
    /// Round trip, its variation, retransmission time-out; window of congestion and threshold, octets.
    struct Figures {
        cosim::Time round_trip = 0, variation = 0, timeout = 0;
        std::uint32_t congestion = 0, threshold = 0, segment = 0;
    };
    Figures figures() const {
        return {smoothed_,   variation_, timeout_,
                congestion_, threshold_, static_cast<std::uint32_t>(segment_)};
    }

  private:
    using Segment = protocols::TcpSegment;

    // tcp_connection.cpp
    void enter(State state, cosim::Time now);
    void end(int error);
    void reset_peer(std::uint32_t sequence);
    bool acceptable(const Segment& segment) const;
    void receive_in_syn_sent(const Segment& segment, cosim::Time now);
    void receive_data(Segment segment, cosim::Time now);
    void receive_fin(cosim::Time now);
    void stir() { ++activity_; }
    void check_peer(cosim::Time now);

    // tcp_sending.cpp
    std::uint32_t data_end() const { return data_begin_ + static_cast<std::uint32_t>(out_data_.size()); }
    std::size_t in_flight_data() const;
    std::uint32_t flight() const { return next_ - unacknowledged_; }
    bool fin_sent() const;
    void receive_acknowledgement(const Segment& segment, cosim::Time now);
    void duplicate_acknowledgement(cosim::Time now);
    void acknowledged(std::uint32_t octets, std::uint32_t number, cosim::Time now);
    void sample(cosim::Time round_trip);
    void send(cosim::Time now);
    void send_segment(std::uint32_t sequence, std::size_t length, bool fin, cosim::Time now);
    void send_first_again(cosim::Time now);
    void send_syn(bool answer);
    void send_acknowledgement();
    Segment bare() const;
    std::uint16_t window();
    void await_acknowledgement(cosim::Time now);
    bool outlasted(cosim::Time since, cosim::Time now) const;
    void timed_out(cosim::Time now);
    void probe(cosim::Time now);
    void ask_peer();

    Endpoint local_, peer_;
    Settings settings_;
    State state_ = State::Closed;
    int error_ = 0;
    std::uint32_t activity_ = 1;
    TcpCounts counts_;
    std::vector<Segment> out_;

    // Sending
    std::uint32_t first_;           ///< sequence number of the SYN
    std::uint32_t unacknowledged_;  ///< SND.UNA
    std::uint32_t next_;            ///< SND.NXT
    std::uint32_t highest_;         ///< one more than the highest number sent
    std::uint32_t data_begin_;      ///< number of out_data_[0]
    std::string out_data_;          ///< not yet acknowledged
    bool closing_ = false;          ///< a FIN follows the data
    std::uint32_t peer_window_ = 0;
    std::uint32_t window_sequence_ = 0, window_acknowledged_ = 0;  ///< of the last window update
    std::uint32_t widest_window_ = 0;
    std::size_t segment_ = 536;  ///< most data in one
    std::uint32_t congestion_ = 0, threshold_ = 0xffffffff;
    int duplicates_ = 0;
    bool recovering_ = false;
    std::uint32_t recover_;  ///< highest number when the last loss was found
    bool timing_ = false;    ///< a segment's round trip is measured
    std::uint32_t timed_ = 0;
    cosim::Time timed_at_ = 0;
    bool measured_ = false;
    cosim::Time smoothed_ = 0, variation_ = 0, timeout_;
    int attempts_ = 0;
    cosim::Time retransmit_at_ = cosim::kNever;
    cosim::Time probe_at_ = cosim::kNever;
    bool more_ = false;                      ///< what was written last is to be continued
    cosim::Time uncork_at_ = cosim::kNever;  ///< part of a segment is held back so long
    int probes_ = 0;                         ///< while the peer has no room
    int unanswered_probes_ = 0;              ///< of them, since it was heard last
    cosim::Time progress_at_ = 0;  ///< last acknowledgement, or first segment since all was acknowledged
    cosim::Time stuck_since_ = 0;  ///< the peer has no room
    cosim::Time keep_at_ = cosim::kNever;  ///< keep-alive: the peer's silence is looked at
    int keep_probes_ = 0;

    // Receiving
    cosim::Time heard_at_ = 0;      ///< last segment
    std::uint32_t expected_ = 0;    ///< RCV.NXT
    std::uint32_t advertised_ = 0;  ///< right edge of the window that the peer knows
    std::string in_;
    std::map<std::uint32_t, std::string> early_;  ///< by distance from the peer's first number
    std::uint32_t peer_first_ = 0;
    bool fin_known_ = false;
    std::uint32_t fin_at_ = 0;
    bool peer_done_ = false, read_shut_ = false, orphan_ = false;
    int unanswered_ = 0;  ///< segments with data since the last acknowledgement
    bool acknowledge_now_ = false;
    cosim::Time acknowledge_at_ = cosim::kNever;
    cosim::Time leave_at_ = cosim::kNever;  ///< end of TimeWait, or of FinWait2 without an owner
};

}  // namespace puckloop::linuxboard
