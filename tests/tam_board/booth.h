#pragma once
// A booth with firmware and a radio module that answers every AT command after a millisecond and acknowledges
// what is sent: what tests of the TAM's firmware, any, share.

#include "protocols/radio/xbee_frame.h"
#include "protocols/radio/xbee_message.h"
#include "protocols/serial/uart_sampling.h"
#include "tests/tam_board/rig.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::tam::test {

using namespace puckloop::protocols;
using cosim::Time;

inline constexpr Time kMs = cosim::kMillisecond;
inline constexpr Time kBit = cosim::kSecond / 9600, kByteTime = 10 * kBit;
inline constexpr Time kStep = kMs / 10;

/// Edges of an IRcom word, the first one rising and at time 0: each of the 12 symbols' half periods ends with
/// an edge, the first one in the dark. MARK (0) is ten half periods of 260 us, SPACE (1) five of 520 us; two
/// MARKs, eight bits, two check bits (facts: tam, section 8).
inline std::vector<Time> ircom_edges(std::uint8_t word) {
    const unsigned check = (4 - static_cast<unsigned>(std::popcount(word)) % 4) % 4;
    const unsigned symbols = static_cast<unsigned>(word) << 2 | check;
    std::vector<Time> edges;
    Time end = -260 * cosim::kMicrosecond;
    for (int symbol = 11; symbol >= 0; --symbol) {
        const bool space = symbols >> symbol & 1u;
        for (int half = 0; half < (space ? 5 : 10); ++half)
            edges.push_back(end += (space ? 520 : 260) * cosim::kMicrosecond);
    }
    if (edges.size() % 2 != 0) edges.pop_back();  // forced low in the end: an odd last edge is lost
    return edges;
}

/// A booth whose radio module answers every AT command after a millisecond, and acknowledges what is sent.
struct Booth {
    Rig rig;
    XBeeReader reader{XBeeApiMode::Escaped};
    std::size_t frames_seen = 0, changes_seen = 0;
    std::vector<std::pair<Time, XBeeMessage>> sent;  ///< by the booth
    XBeeBytes sent_bytes;
    std::vector<std::pair<Time, std::uint8_t>> to_booth;  ///< bytes, by the start of their stop bit
    Time line_free = 0;
    bool answers = true, acknowledges = true;
    std::uint8_t found_status = 0x40;  ///< of the answer to DN; other modules say 0
    std::string console;
    std::map<std::string, XBeeBytes> values;  ///< of AT commands, where they matter

    explicit Booth(const std::string& image) {
        rig.board.load(image::load_avr_image(image, avr::atmega1284p().image_part()));
    }
    Booth(const Booth&) = delete;
    Booth& operator=(const Booth&) = delete;

    void send(const XBeeMessage& message, Time at) {
        for (const std::uint8_t byte : encode_xbee(encode(message), XBeeApiMode::Escaped)) {
            line_free = std::max(line_free, at) + kByteTime;
            to_booth.emplace_back(line_free - kBit, byte);
        }
    }
    void answer(const XBeeMessage& message, Time at) {
        if (const auto* command = std::get_if<XBeeAt>(&message); command && answers) {
            XBeeAtResponse response{.command = command->command, .value = {}};
            const std::string name(command->command.begin(), command->command.end());
            if (values.contains(name)) {
                response.value = values.at(name);
            } else if (name == "DN") {
                response.status = found_status;
                response.value = {0xFF, 0xFE, 0x00, 0x13, 0xA2, 0x00, 0x40, 0x8A, 0x31, 0x07};
            } else if (name == "NI") {
                response.value = {'T', 'A', 'M', '0', '1'};
            } else if (name != "NT") {
                response.value = {0, 0, 0, 1};
            }
            send(response, at + kMs);
        }
        if (const auto* data = std::get_if<XBeeTx>(&message); data && acknowledges)
            send(XBeeTxStatus{.id = data->id}, at + 5 * kMs);
    }
    void run_until(Time until) {
        for (Time now = rig.board.now(); now < until;) {
            Time next = std::min(until, now + kStep);
            if (!to_booth.empty()) next = std::min(next, std::max(now, to_booth.front().first));
            rig.board.run_until(next);
            now = next;
            while (!to_booth.empty() && to_booth.front().first <= now) {
                const auto [stop_bit, byte] = to_booth.front();
                to_booth.erase(to_booth.begin());
                cosim::UartFrame frame;
                frame.bit_period = kBit;
                frame.start = stop_bit - 9 * kBit;
                frame.data = byte;
                rig.board.uart_receive(kXBeeUnit, frame);
            }
            listen();
        }
    }
    void listen() {
        for (; changes_seen < rig.changes.size(); ++changes_seen) {
            const auto& change = rig.changes[changes_seen];
            if (change.id == kXBeeReset && change.value == 0.0 && answers)
                send(XBeeModemStatus{}, change.at + 50 * kMs);
        }
        for (; frames_seen < rig.frames.size(); ++frames_seen) {
            const auto& [unit, frame] = rig.frames[frames_seen];
            if (unit == kConsoleUnit) console += static_cast<char>(frame.data);
            if (unit != kXBeeUnit) continue;
            sent_bytes.push_back(static_cast<std::uint8_t>(frame.data));
            const auto reading = reader.take(static_cast<std::uint8_t>(frame.data));
            if (!reading) continue;
            REQUIRE(reading->ok());
            const Time at = frame.start + kByteTime;
            sent.emplace_back(at, decode_xbee(reading->data));
            answer(sent.back().second, at);
        }
    }
    /// Payloads of the reports to the coordinator, with their times.
    std::vector<std::pair<Time, XBeeBytes>> reports() const {
        std::vector<std::pair<Time, XBeeBytes>> found;
        for (const auto& [at, message] : sent)
            if (const auto* data = std::get_if<XBeeTx>(&message)) found.emplace_back(at, data->data);
        return found;
    }
    /// A robot sends a word, beginning at `begin`; all half periods longer by `stretch`.
    void hear(std::uint8_t word, Time begin, double stretch = 1.0) {
        bool level = false;
        for (const Time edge : ircom_edges(word)) {
            run_until(begin + static_cast<Time>(static_cast<double>(edge) * stretch));
            rig.board.set_signal(kProximitySense, level ? 0.0 : 1.0);
            level = !level;
        }
        rig.board.set_signal(kProximitySense, 0.0);
    }
    /// Runs until the booth begins a word of its own, at most a second.
    void run_until_word() {
        const std::size_t edges = rig.of(kProximityEmit).size();
        for (int i = 0; i < 1000 && rig.of(kProximityEmit).size() == edges; ++i)
            run_until(rig.board.now() + kMs);
    }
    void command(XBeeBytes payload) {
        send(XBeeRx{.from = 0x0013A200408A3107, .options = 1, .data = std::move(payload)}, rig.board.now());
    }
};

inline double ms(Time time) {
    return static_cast<double>(time) / static_cast<double>(kMs);
}

}  // namespace puckloop::tam::test
