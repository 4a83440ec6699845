#include "cosim/remote/mpi/mpi_hosts.h"

#include "cosim/core/wall_clock.h"
#include "cosim/remote/mpi/rank_server.h"
#include "cosim/remote/protocol.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace puckloop::cosim {

class MpiHosts::Line : public NodeLine {
  public:
    Line(MpiHosts& hosts, int rank, int tag) : hosts_(hosts), rank_(rank), tag_(tag) {}
    ~Line() override { close(); }

    bool send(std::span<const std::uint8_t> bytes, std::chrono::nanoseconds) override {
        // What was sent before was answered.
        outgoing_.send(rank_, tag_, bytes);
        ++hosts_.traffic_.messages;
        hosts_.traffic_.bytes += bytes.size();
        return true;
    }

    bool receive(std::chrono::nanoseconds limit) override {
        const auto begun = WallClock::now();
        while (!came_) {
            if (hosts_.take_one()) continue;
            if (WallClock::now() - begun >= limit) return false;
            hosts_.patience_.wait();
        }
        came_ = false;
        if (incoming_.size() <= protocol::kLengthBytes) throw CodecError("a message of impossible length");
        return true;
    }
    std::span<const std::uint8_t> body() const override {
        return std::span(incoming_).subspan(protocol::kLengthBytes);
    }

    // mpirun ends a job of which a rank is gone.
    bool ended() override { return false; }
    std::string ending() override { return "is gone"; }
    void close() override { hosts_.lines_[static_cast<std::size_t>(tag_ - kFirstNodeTag)] = nullptr; }
    std::string place() const override { return fmt::format("rank {}", rank_); }

    void take(Bytes& bytes) {
        incoming_.swap(bytes);
        came_ = true;
    }

  private:
    MpiHosts& hosts_;
    int rank_;
    int tag_;
    Outgoing outgoing_;
    Bytes incoming_;
    bool came_ = false;
};

MpiHosts::MpiHosts(const MessagePassing& job) : job_(job) {}

bool MpiHosts::end(std::chrono::seconds patience) {
    for (int rank = 1; rank < job_.ranks(); ++rank)
        Outgoing().send(rank, kEndTag, {});
    const auto begun = WallClock::now();
    for (unsigned ended = 0; ended < count();) {
        if (const auto origin = take_message(bytes_)) {
            if (origin->tag == kEndTag) ++ended;
        } else if (WallClock::now() - begun > patience) {
            return false;
        } else {
            patience_.wait();
        }
    }
    return true;
}

std::unique_ptr<NodeLine> MpiHosts::line_to(unsigned host) {
    auto line = std::make_unique<Line>(*this, static_cast<int>(host),
                                       kFirstNodeTag + static_cast<int>(lines_.size()));
    lines_.push_back(line.get());
    return line;
}

void MpiHosts::await_answers() {
    const auto begun = WallClock::now();
    while (!take_one() && WallClock::now() - begun < kWaitSlice)
        patience_.wait();
    traffic_.waited_s += seconds_since(begun);
    ++traffic_.waits;
}

/// Gives a message that has come to its line.
bool MpiHosts::take_one() {
    const auto origin = take_message(bytes_);
    if (!origin) return false;
    patience_.renew();
    ++traffic_.messages;
    traffic_.bytes += bytes_.size();
    const auto line = static_cast<std::size_t>(origin->tag - kFirstNodeTag);
    if (origin->tag >= kFirstNodeTag && line < lines_.size() && lines_[line]) lines_[line]->take(bytes_);
    return true;
}

/// The answer is in bytes_.
void MpiHosts::ask(unsigned host, int tag, std::span<const std::uint8_t> bytes) {
    Outgoing outgoing;
    outgoing.send(static_cast<int>(host), tag, bytes);
    while (!take_message(bytes_)) {
    }
}

double MpiHosts::worked_s() {
    double all = 0;
    for (unsigned host = 1; host <= count(); ++host) {
        ask(host, kWorkTag, {});
        all += ByteReader(bytes_).f64();
    }
    return all;
}

double MpiHosts::round_trip_s(unsigned host) {
    constexpr std::size_t kTimes = 200, kLength = 64;  // a grant with a message or two
    const std::array<std::uint8_t, kLength> sent{};
    std::vector<double> took;
    for (std::size_t i = 0; i < kTimes; ++i) {
        const auto begun = WallClock::now();
        ask(host, kEchoTag, sent);
        took.push_back(seconds_since(begun));
    }
    std::nth_element(took.begin(), took.begin() + kTimes / 2, took.end());
    return took[kTimes / 2];
}

}  // namespace puckloop::cosim
