#pragma once
// Packets of a trace into a pcapng file in the order of their times.

#include "cosim/core/time.h"
#include "cosim/trace/trace_row.h"
#include "protocols/network/pcapng.h"
#include "traces/reorder_buffer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

namespace puckloop::tools {

/// Packets come as they are complete: each is kept until nothing earlier can come, as release() states. One
/// that comes later still has the time of the packet before it, and its own in the comment. So has one that
/// is behind others that had to be written because too much was kept.
class OrderedWriter : public pcapng::Writer {
  public:
    using pcapng::Writer::Writer;

    /// Octets of data and comments that are kept at most; with what each packet takes besides, memory is some
    /// twice that.
    static constexpr std::size_t kMostKept = 16UL << 20;

    void packet(std::uint32_t interface, cosim::Time time, pcapng::Bytes data, std::string comment) {
        octets_ += size_of(data, comment);
        kept_.push(std::max<cosim::Time>(time, 0), {interface, std::move(data), std::move(comment)});
        while (octets_ > kMostKept)
            write_first();
    }
    /// Writes what is kept and begins before `end`.
    void release(cosim::Time end) {
        while (!kept_.empty() && kept_.first() < end)
            write_first();
    }
    std::size_t octets_kept() const { return octets_; }

  private:
    struct Packet {
        std::uint32_t interface = 0;
        pcapng::Bytes data;
        std::string comment;
    };
    static std::size_t size_of(const pcapng::Bytes& data, const std::string& comment) {
        return sizeof(Packet) + data.size() + comment.size();
    }
    void write_first() {
        constexpr cosim::Time kNanosecond = 1000;
        const cosim::Time time = kept_.first();
        Packet one = kept_.pop();
        octets_ -= size_of(one.data, one.comment);
        if (time < written_)
            one.comment +=
                fmt::format("{}began at {} s", one.comment.empty() ? "" : "; ", cosim::format_seconds(time));
        written_ = std::max(written_, time);
        pcapng::Writer::packet(one.interface, static_cast<std::uint64_t>(written_ / kNanosecond), one.data,
                               one.comment);
    }

    ReorderBuffer<Packet> kept_;
    std::size_t octets_ = 0;
    cosim::Time written_ = 0;
};

}  // namespace puckloop::tools
