#pragma once
// Modules with hosts at their serial lines, as the node of a run has them: what a host sends goes in as
// characters, what its module answers comes out as packets and bytes with their times.

#include "base/json.h"
#include "emu/bluetooth/air_node.h"
#include "protocols/radio/lmx9820_packet.h"
#include "protocols/serial/uart_sampling.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::bluetooth::test {

using cosim::Time;
using protocols::LmxPacket;

inline constexpr Time kMs = cosim::kMillisecond;
inline constexpr Time kBit = 8'680'556;  // 115200 baud

inline Address address_of(std::size_t robot) {
    return {static_cast<std::uint8_t>(robot + 1), 0, 0x2C, 0x17, 0x00, 0x08};
}

/// Robots in a row, 1 m apart, each called "r<i>" and with a PIN of its own.
inline AirSpec robots(std::size_t count, std::uint64_t seed = 1) {
    AirSpec spec;
    spec.seed = seed;
    for (std::size_t i = 0; i < count; ++i) {
        RobotModule robot;
        robot.module.name = "r" + std::to_string(i);
        robot.module.settings.name = "e-puck_000" + std::to_string(i + 1);
        robot.module.settings.pin = "000" + std::to_string(i + 1);
        robot.module.settings.address = address_of(i);
        robot.pose = static_cast<int>(3 * i);
        spec.modules.push_back(robot);
    }
    return spec;
}

inline Bytes with(Bytes data, const Address& address, Bytes rest = {}) {
    data.insert(data.end(), address.begin(), address.end());
    data.insert(data.end(), rest.begin(), rest.end());
    return data;
}

class Air {
  public:
    struct Said {
        Time at = 0;
        LmxPacket packet{};
    };
    struct Line {
        std::vector<Said> said{};  ///< packets, when their last stop bit begins
        Bytes plain{};             ///< bytes that are in no packet
        int breaks = 0;
        protocols::LmxReader reader{};
        Time free = 0;
    };

    explicit Air(const AirSpec& spec) : node(spec), lines(node.ports().size() - 1) {
        for (std::size_t i = 0; i < spec.modules.size(); ++i)
            place(i, static_cast<double>(i), 0.0);
    }

    void place(std::size_t robot, double x, double y) {
        const auto world = static_cast<cosim::PortIndex>(lines.size());
        put({now_, world, cosim::Signal{static_cast<std::uint16_t>(3 * robot), x}});
        put({now_, world, cosim::Signal{static_cast<std::uint16_t>(3 * robot + 1), y}});
    }
    void say(std::size_t port, std::span<const std::uint8_t> bytes, Time bit = kBit) {
        for (const std::uint8_t byte : bytes) {
            cosim::UartFrame frame;
            frame.start = std::max(now_, lines[port].free);
            frame.bit_period = bit;
            frame.data = byte;
            put_frame(port, frame);
        }
    }
    void say_text(std::size_t port, const std::string& text) { say(port, Bytes(text.begin(), text.end())); }
    void say_break(std::size_t port) {
        cosim::UartFrame frame;
        frame.start = std::max(now_, lines[port].free);
        frame.bit_period = kBit;
        frame.is_break = 1;
        put_frame(port, frame);
    }
    void request(std::size_t port, std::uint8_t opcode, const Bytes& data = {}) {
        say(port, protocols::encode_lmx({protocols::kLmxRequest, opcode, data}));
    }

    /// Runs on for `time` in steps, and checks what the node states of its future.
    void run(Time time, Time step = cosim::kNever) {
        const Time until = now_ + time;
        while (now_ < until) {
            const Time next = step > until - now_ ? until : now_ + step;
            std::vector<cosim::Message> inbox, outbox;
            while (!waiting_.empty() && waiting_.front().time < next) {
                inbox.push_back(waiting_.front());
                waiting_.erase(waiting_.begin());
            }
            std::vector<Time> bound;
            for (cosim::PortIndex p = 0; p < lines.size(); ++p)
                bound.push_back(std::min(
                    node.earliest_output(p),
                    inbox.empty() ? cosim::kNever : cosim::later(inbox.front().time, node.lookahead(p))));
            node.advance(next, inbox, outbox);
            bool kept = true;
            for (const cosim::Message& message : outbox) {
                kept = kept && message.time >= bound[message.port];
                take(message);
            }
            CHECK(kept);
            now_ = next;
        }
    }
    /// Everything is up; what was said so far is forgotten.
    void boot() {
        run(1000 * kMs);
        forget();
    }
    void forget() {
        for (Line& line : lines) {
            line.said.clear();
            line.plain.clear();
            line.breaks = 0;
        }
    }
    /// A request and the one packet that answers it at once.
    Bytes ask(std::size_t port, std::uint8_t opcode, const Bytes& data = {}) {
        const std::size_t before = lines[port].said.size();
        request(port, opcode, data);
        run(60 * kMs);
        REQUIRE(lines[port].said.size() == before + 1);
        const LmxPacket& packet = lines[port].said.back().packet;
        CHECK(packet.type == protocols::kLmxConfirm);
        CHECK(packet.opcode == opcode);
        return packet.data;
    }
    std::vector<LmxPacket> packets(std::size_t port) const {
        std::vector<LmxPacket> all;
        for (const Said& said : lines[port].said)
            all.push_back(said.packet);
        return all;
    }
    /// A link from port 1 of `from` to port 1 of `to`, known to both; nothing is kept of what was said.
    void link(std::size_t from, std::size_t to) {
        request(from, 0x17, {4, '0', '0', '0', static_cast<std::uint8_t>('1' + to)});
        request(from, 0x0A, with({1}, address_of(to), {1}));
        run(60 * cosim::kSecond);
        REQUIRE(lines[from].said.back().packet.opcode == 0x0B);
        REQUIRE(lines[from].said.back().packet.data[0] == kRfcommOk);
        forget();
    }
    Time now() const { return now_; }
    nlohmann::json report() { return nlohmann::json::parse(node.finish()); }

    AirNode node;
    std::vector<Line> lines;

  private:
    void put_frame(std::size_t port, const cosim::UartFrame& frame) {
        lines[port].free = protocols::frame_end(frame);
        put({protocols::stop_bit_start(frame), static_cast<cosim::PortIndex>(port), frame});
    }
    void put(cosim::Message message) {
        const auto at =
            std::upper_bound(waiting_.begin(), waiting_.end(), message.time,
                             [](Time time, const cosim::Message& one) { return time < one.time; });
        waiting_.insert(at, std::move(message));
    }
    void take(const cosim::Message& message) {
        Line& line = lines[message.port];
        const auto& frame = std::get<cosim::UartFrame>(message.payload);
        if (frame.is_break != 0) {
            ++line.breaks;
            return;
        }
        const auto byte = static_cast<std::uint8_t>(frame.data);
        const auto reading = line.reader.take(byte);
        if (!reading && line.reader.idle()) line.plain.push_back(byte);
        if (!reading) return;
        REQUIRE(reading->ok());
        line.said.push_back({message.time, reading->packet});
    }

    std::vector<cosim::Message> waiting_;
    Time now_ = 0;
};

}  // namespace puckloop::bluetooth::test
