// A flood of packets, of which each may have to wait for an earlier one, in bounded memory.

#include "traces/formats/pcapng_writer.h"

#include <catch2/catch.hpp>

#include <sstream>

using namespace puckloop;
using tools::OrderedWriter;

namespace {

/// Counts what is written, and keeps none.
class Counter : public std::streambuf {
  public:
    std::size_t octets = 0;

  protected:
    std::streamsize xsputn(const char*, std::streamsize count) override {
        octets += static_cast<std::size_t>(count);
        return count;
    }
    int overflow(int character) override {
        ++octets;
        return character;
    }
};

}  // namespace

TEST_CASE("packets are written in the order of their times", "[pcapng]") {
    std::ostringstream out;
    OrderedWriter writer(out);
    const auto air = writer.interface("air", pcapng::LinkType::Ip4);
    for (const int time : {30, 10, 20})
        writer.packet(air, time * cosim::kMillisecond, {static_cast<std::uint8_t>(time)}, "");
    const std::size_t before = out.str().size();
    writer.release(cosim::kMillisecond);
    CHECK(out.str().size() == before);
    writer.release(cosim::kNever);
    const std::string text = out.str().substr(before);
    CHECK(text.find('\x0a') < text.find('\x14'));
    CHECK(text.find("began at") == std::string::npos);
    CHECK(writer.octets_kept() == 0);
}

TEST_CASE("a flood is not kept beyond a bound while an earlier packet may come", "[pcapng]") {
    Counter counter;
    std::ostream out(&counter);
    OrderedWriter writer(out);
    const auto air = writer.interface("air", pcapng::LinkType::Ip4);
    constexpr std::size_t kPackets = 60'000, kOctets = 1500;  // 90 MB
    std::size_t most = 0;
    for (std::size_t i = 0; i < kPackets; ++i) {
        writer.packet(air, static_cast<cosim::Time>(i + 1) * cosim::kMicrosecond, pcapng::Bytes(kOctets), "");
        most = std::max(most, writer.octets_kept());
    }
    CHECK(most <= OrderedWriter::kMostKept);
    CHECK(counter.octets > kPackets * kOctets - OrderedWriter::kMostKept);
    // What comes too late for its place says so.
    std::ostringstream late;
    OrderedWriter small(late);
    small.packet(small.interface("air", pcapng::LinkType::Ip4), 2 * cosim::kSecond, {1}, "");
    small.release(cosim::kNever);
    small.packet(0, cosim::kSecond, {2}, "");
    small.release(cosim::kNever);
    CHECK(late.str().find("began at 1.000000000000 s") != std::string::npos);
}
