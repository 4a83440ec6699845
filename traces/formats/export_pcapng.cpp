// What becomes a packet: bursts of bytes, segments of I2C transfers, radio and CAN frames, packets of a
// network.

#include "protocols/serial/uart_sampling.h"
#include "traces/can_frames.h"
#include "traces/formats/export.h"
#include "traces/formats/pcapng_stream.h"
#include "traces/formats/pcapng_writer.h"
#include "traces/i2c_transfers.h"
#include "traces/received.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace puckloop::tools {

namespace {

using cosim::Time;
using Bytes = pcapng::Bytes;
using pcapng::LinkType;
using Writer = OrderedWriter;

// Events of LINKTYPE_RTAC_SERIAL.
enum : std::uint8_t { kDataSent = 1, kFramingError = 7, kParityError = 8, kBreak = 9 };

constexpr std::size_t kMostInPacket = 256;
/// How late a row may be, behind the begin of what it holds: a frame at 120 bit/s, a byte whose clock is
/// held.
constexpr Time kLatest = 100 * cosim::kMillisecond;
/// A transfer that nobody ends holds up the others for no longer.
constexpr Time kLongestOpen = 10 * cosim::kSecond;

void big(Bytes& out, std::uint64_t value, int bytes) {
    for (int i = bytes - 1; i >= 0; --i)
        out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

std::string fault_text(cosim::FaultKind fault) {
    if (fault == cosim::FaultKind::None) return {};
    return fmt::format("fault: {}{}", fault_name(fault), keeps_from_arriving(fault) ? ", not received" : "");
}

/// Bytes of one sender until a pause.
class Serial {
  public:
    void add(Writer& out, const cosim::TraceRow& row, const cosim::UartFrame& frame) {
        if (keeps_from_arriving(row.fault))
            return alone(out, row, frame, static_cast<std::uint8_t>(frame.data), kDataSent);
        const auto characters = receiver_.take(row, frame);
        if (characters.empty()) return alone(out, row, frame, std::nullopt, kDataSent);
        for (const protocols::ReceivedCharacter& one : characters) {
            const auto byte = static_cast<std::uint8_t>(one.data);
            if (one.is_break) {
                alone(out, row, frame, std::nullopt, kBreak);
            } else if (row.fault != cosim::FaultKind::None || one.framing_error || one.parity_error) {
                alone(out, row, frame, byte,
                      one.framing_error  ? kFramingError
                      : one.parity_error ? kParityError
                                         : kDataSent);
            } else {
                if (frame.start > pause_from_ || data_.size() == kMostInPacket) flush(out);
                begin(out, row, frame);
                data_.push_back(byte);
            }
        }
    }

    LineReceiver& receiver() { return receiver_; }
    Time begun() const { return empty_ ? cosim::kNever : start_; }
    /// Nothing can follow without a pause any more.
    bool rests(Time now) const { return empty_ || now > settled_; }

    void flush(Writer& out) {
        if (empty_) return;
        Bytes packet;
        big(packet, static_cast<std::uint64_t>(start_ / cosim::kSecond), 4);
        big(packet, static_cast<std::uint64_t>(start_ % cosim::kSecond / cosim::kMicrosecond), 4);
        packet.insert(packet.end(), {event_, 0, 0, 0});
        packet.insert(packet.end(), data_.begin(), data_.end());
        out.packet(interface_, start_, packet, comment_);
        data_.clear();
        comment_.clear();
        event_ = kDataSent;
        empty_ = true;
    }

  private:
    void begin(Writer& out, const cosim::TraceRow& row, const cosim::UartFrame& frame) {
        if (std::exchange(empty_, false)) {
            start_ = frame.start;
            interface_ = out.interface(fmt::format("{} {}", row.link, row.from), LinkType::Uart);
        }
        pause_from_ = protocols::frame_end(frame) + frame.bit_period;
        settled_ = pause_from_ + kSlackBits * frame.bit_period;
    }
    /// In a packet of its own.
    void alone(Writer& out, const cosim::TraceRow& row, const cosim::UartFrame& frame,
               std::optional<std::uint8_t> byte, std::uint8_t event) {
        flush(out);
        begin(out, row, frame);
        if (byte) data_.push_back(*byte);
        event_ = event;
        comment_ = fault_text(row.fault);
        flush(out);
    }

    static constexpr Time kSlackBits = 24;  // a frame is recorded when it ends, and later where it was late

    LineReceiver receiver_;
    Bytes data_;
    bool empty_ = true;
    std::uint8_t event_ = kDataSent;
    std::string comment_;
    Time start_ = 0, pause_from_ = 0, settled_ = 0;
    std::uint32_t interface_ = 0;
};

/// What lies between a START and the next START or STOP, on one bus.
class Segment {
  public:
    void add(Writer& out, const I2cStep& step, std::uint8_t bus, const std::vector<const FaultMark*>& marks) {
        using Kind = I2cStep::Kind;
        if (step.end == I2cStep::End::Lost) {
            flush(out);
            begin(out, step, bus);
            note("bus lost");
            for (const FaultMark* mark : marks)
                note("fault: " + mark->text());
            return flush(out);
        }
        if (step.kind == Kind::Start || step.kind == Kind::Stop) flush(out);
        if (step.kind == Kind::Start) begin(out, step, bus);
        if (packet_.empty() || step.kind == Kind::Stop) return;
        packet_.push_back(step.byte);
        if (step.end == I2cStep::End::Abandoned)
            note("no answer");
        else if (!step.acknowledged && step.kind == Kind::Start)
            note("address not acknowledged");
        else if (!step.acknowledged && step.kind == Kind::Write)
            note(fmt::format("byte {} not acknowledged", packet_.size() - kHeader - 1));
        if (step.fault != cosim::FaultKind::None) note(fault_text(step.fault));
        for (const FaultMark* mark : marks)
            note("fault: " + mark->text());
    }

    void flush(Writer& out) {
        if (packet_.size() > kHeader || !comment_.empty()) out.packet(interface_, start_, packet_, comment_);
        packet_.clear();
        comment_.clear();
    }

    /// kNever: nothing is open.
    Time begun() const { return packet_.empty() ? cosim::kNever : start_; }

  private:
    static constexpr std::size_t kHeader = 5;

    void begin(Writer& out, const I2cStep& step, std::uint8_t bus) {
        start_ = step.start;
        interface_ = out.interface(step.bus, LinkType::I2c);
        packet_.push_back(bus);
        big(packet_, step.byte & 1U, 4);  // I2C_M_RD
        if (step.end == I2cStep::End::Lost) packet_.push_back(step.byte);
    }
    void note(const std::string& text) { comment_ += (comment_.empty() ? "" : "; ") + text; }

    Bytes packet_;
    std::string comment_;
    Time start_ = 0;
    std::uint32_t interface_ = 0;
};

}  // namespace

struct PcapngStream::Parts {
    Parts(std::ostream& out, const FaultMarks* known)
        : writer(out),
          marks(known != nullptr ? *known : kNoMarks),
          alone(marks),
          transfers([this](const I2cStep& step) {
              constexpr std::size_t kMostBuses = 128;
              const auto bus = buses.try_emplace(step.bus, buses.size() % kMostBuses).first->second;
              segments[step.link].add(writer, step, bus, marks.of_byte(step.bus, step.start));
          }) {}

    void add(const cosim::TraceRow& row) {
        while (const FaultMark* mark = alone.next(row.time))
            add(*mark);
        // Bursts that have ended, first.
        for (auto one = open.begin(); one != open.end();) {
            if (!(*one)->rests(row.time)) {
                ++one;
                continue;
            }
            (*one)->flush(writer);
            one = open.erase(one);
        }
        if (const auto* frame = std::get_if<cosim::UartFrame>(&row.payload)) {
            Serial& sender = serial[{row.link, row.from}];
            if (const auto setting = setting_of(row, *frame)) settings.insert_or_assign(row.link, *setting);
            if (const auto known = settings.find(row.link); known != settings.end())
                sender.receiver().assume(known->second);
            sender.add(writer, row, *frame);
            if (std::find(open.begin(), open.end(), &sender) == open.end()) open.push_back(&sender);
        } else if (const auto* phase = std::get_if<cosim::I2cPhase>(&row.payload)) {
            transfers.add(row, *phase);
        } else if (const auto* radio = radio_on_air(row)) {
            const auto octets = radio->octets.view();
            writer.packet(writer.interface(fmt::format("{} {}", row.link, row.from), LinkType::Radio),
                          radio->start, {octets.begin(), octets.end()}, fault_text(row.fault));
        } else if (const cosim::Packet* packet = sent_packet(row)) {
            const auto octets = packet->octets.view();
            writer.packet(writer.interface(fmt::format("{} {}", row.link, row.from), LinkType::Ip4),
                          packet->start, {octets.begin(), octets.end()}, fault_text(row.fault));
        } else if (const auto heard = can_on_bus(row)) {
            const bool failed = heard->error != protocols::CanError::None;
            writer.packet(writer.interface(heard->bus, LinkType::Can), heard->start, heard->socketcan(),
                          failed ? fmt::format("{} {}: {}", heard->sender, heard->text(), heard->error_text())
                                 : heard->sender);
        }
        release(row.time);
    }

    /// What nothing of this time and later can precede.
    void release(Time now) {
        Time end = now - kLatest;
        for (const Serial* one : open)
            end = std::min(end, one->begun());
        for (const auto& [link, segment] : segments)
            end = std::min(end, segment.begun());
        writer.release(std::max(end, now - kLongestOpen));
    }

    void end() {
        for (Serial* one : open)
            one->flush(writer);
        open.clear();
        transfers.end();
        while (const FaultMark* mark = alone.next(cosim::kNever))
            add(*mark);
        for (auto& [link, segment] : segments)
            segment.flush(writer);
        writer.release(cosim::kNever);
    }

    /// A packet of its own, as one of those that programs hand to Wireshark: the name of the dissector, text.
    void add(const FaultMark& mark) {
        constexpr std::string_view kDissector = "data-text-lines";
        constexpr std::uint64_t kNameOfDissector = 12, kEndOfTags = 0;
        const std::string text = mark.text();
        Bytes packet;
        big(packet, kNameOfDissector, 2);
        const std::size_t padded = (kDissector.size() + 3) / 4 * 4;
        big(packet, padded, 2);
        packet.insert(packet.end(), kDissector.begin(), kDissector.end());
        packet.resize(packet.size() + padded - kDissector.size());
        big(packet, kEndOfTags, 4);
        packet.insert(packet.end(), text.begin(), text.end());
        writer.packet(writer.interface(mark.place + " faults", LinkType::Export), mark.time, packet,
                      "fault: " + text);
    }

    static const FaultMarks kNoMarks;
    Writer writer;
    const FaultMarks& marks;
    FaultMarkCursor alone;
    std::map<std::pair<std::string, std::string>, Serial> serial;
    std::vector<Serial*> open;
    std::map<std::string, protocols::UartReceiver> settings;  // of links, by either end
    std::map<std::string, Segment> segments;
    std::map<std::string, std::uint8_t> buses;
    I2cTransfers transfers;
};

const FaultMarks PcapngStream::Parts::kNoMarks;

PcapngStream::PcapngStream(std::ostream& out, const FaultMarks* marks)
    : parts_(std::make_unique<Parts>(out, marks)) {}
PcapngStream::~PcapngStream() = default;

void PcapngStream::add(const cosim::TraceRow& row) {
    parts_->add(row);
}
void PcapngStream::end() {
    parts_->end();
}

void export_pcapng(const RecordedTrace& trace, std::ostream& out) {
    const FaultMarks marks(trace);
    PcapngStream stream(out, &marks);
    trace.for_each_checked([&](const cosim::TraceRow& row) { stream.add(row); });
    stream.end();
}

}  // namespace puckloop::tools
