#pragma once
// A radio module with a host at its serial line: what the host sends goes in as bytes at 9600 baud, what the
// module answers comes out as frames with their times. The air is the test's own.

#include "base/json.h"
#include "emu/xbee/module_node.h"
#include "protocols/radio/xbee_frame.h"
#include "protocols/radio/xbee_message.h"
#include "protocols/serial/uart_sampling.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::xbee::test {

using namespace puckloop::protocols;
using cosim::Time;

inline constexpr Time kMs = cosim::kMillisecond, kUs = cosim::kMicrosecond;
inline constexpr Time kBit = 104 * kUs;  // 9615 baud, as module and TAM have it

inline ModuleOptions escaped(std::string identifier = "TAM07") {
    ModuleOptions options;
    options.name = "m";
    options.address = 0x0013A200408C04A4;
    options.node_identifier = std::move(identifier);
    options.parameters = {{"AP", 2}, {"BD", 3}, {"ID", 0x01B5}};
    return options;
}

class Host {
  public:
    explicit Host(const ModuleOptions& options = escaped())
        : node(options,
               {{"xbee_reset", 1}, {"xbee_rts", 2}, {"power", 3}, {"xbee_cts", 4}, {"xbee_wake", 5}}) {}

    void say_bytes(std::span<const std::uint8_t> bytes, Time bit = kBit) {
        Time start = std::max(now_, line_free_);
        for (const std::uint8_t byte : bytes) {
            cosim::UartFrame frame;
            frame.start = start;
            frame.bit_period = bit;
            frame.data = byte;
            put({stop_bit_start(frame), ModuleNode::kUart, frame});
            start += 10 * bit;
        }
        line_free_ = start;
    }
    void say(const XBeeMessage& message, XBeeApiMode mode = XBeeApiMode::Escaped) {
        say_bytes(encode_xbee(encode(message), mode));
    }
    void pin(std::uint16_t id, double level) { put({now_, ModuleNode::kPins, cosim::Signal{id, level}}); }
    /// A frame from the air, now.
    void hear(const MeshFrame& frame, std::int8_t dbm = -50) { hear_octets(encode_mesh(frame), kMs, dbm); }
    void hear_octets(const std::vector<std::uint8_t>& octets, Time on_air, std::int8_t dbm = -50) {
        put({now_, ModuleNode::kRadio,
             cosim::RadioFrame{now_ - on_air, on_air, cosim::Octets(octets), 12, dbm}});
    }
    void fate(const radio::RadioOutcome& outcome) { hear_octets(radio::encode(outcome), 0); }

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
            std::array<Time, 3> bound{};
            for (cosim::PortIndex p = 0; p < bound.size(); ++p)
                bound[p] = std::min(node.earliest_output(p),
                                    inbox.empty() ? cosim::kNever
                                                  : cosim::later(inbox.front().time, node.lookahead(p)));
            node.advance(next, inbox, outbox);
            for (const cosim::Message& message : outbox) {
                CHECK(message.time >= bound[message.port]);
                take(message);
            }
            now_ = next;
        }
    }
    /// Powered up and ready; what it said so far is forgotten.
    void boot() {
        run(100 * kMs);
        said.clear();
        sent.clear();
        words.clear();
        bytes.clear();
        starts.clear();
    }
    /// Says a command and returns the answer's status and value.
    XBeeAtResponse ask(const std::string& command, XBeeBytes value = {}, bool queued = false) {
        const XBeeCommand name{command[0], command[1]};
        if (queued)
            say(XBeeQueuedAt{.id = 9, .command = name, .value = std::move(value)});
        else
            say(XBeeAt{.id = 9, .command = name, .value = std::move(value)});
        const std::size_t before = said.size();
        run(100 * kMs);
        REQUIRE(said.size() == before + 1);
        const auto* answer = std::get_if<XBeeAtResponse>(&said.back().second);
        REQUIRE(answer != nullptr);
        CHECK(answer->id == 9);
        CHECK(answer->command == name);
        return *answer;
    }
    Time now() const { return now_; }
    nlohmann::json report() { return nlohmann::json::parse(node.finish()); }
    template <class Message>
    std::vector<Message> all() const {
        std::vector<Message> found;
        for (const auto& [at, message] : said)
            if (const auto* one = std::get_if<Message>(&message)) found.push_back(*one);
        return found;
    }

    ModuleNode node;
    std::vector<std::pair<Time, XBeeMessage>>
        said;                  ///< by the module to its host, when the last stop bit begins
    XBeeBytes bytes;           ///< the same as bytes
    std::vector<Time> starts;  ///< of the bytes
    std::vector<std::pair<Time, MeshFrame>> sent;  ///< by the module to the air
    std::vector<std::pair<Time, radio::RadioSettings>> words;
    std::vector<double> cts;
    XBeeReader reader{XBeeApiMode::Escaped};

  private:
    void put(cosim::Message message) {
        const auto at =
            std::upper_bound(waiting_.begin(), waiting_.end(), message.time,
                             [](Time time, const cosim::Message& one) { return time < one.time; });
        waiting_.insert(at, std::move(message));
    }
    void take(const cosim::Message& message) {
        if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload)) {
            bytes.push_back(static_cast<std::uint8_t>(frame->data));
            starts.push_back(frame->start);
            if (const auto reading = reader.take(bytes.back())) {
                if (!reading->ok()) return;
                said.emplace_back(message.time, decode_xbee(reading->data));
            }
        } else if (const auto* radio = std::get_if<cosim::RadioFrame>(&message.payload)) {
            if (radio->duration == 0) {
                const auto settings = radio::decode_settings(radio->octets.view());
                REQUIRE(settings);
                words.emplace_back(message.time, *settings);
            } else {
                const auto reading = decode_mesh(radio->octets.view());
                REQUIRE(reading.fault == MeshFault::None);
                sent.emplace_back(message.time, reading.frame);
            }
        } else if (const auto* signal = std::get_if<cosim::Signal>(&message.payload)) {
            CHECK(signal->id == 4);
            cts.push_back(signal->value);
        }
    }

    std::vector<cosim::Message> waiting_;
    Time now_ = 0, line_free_ = 0;
};

}  // namespace puckloop::xbee::test
