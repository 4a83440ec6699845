#pragma once
// A radio medium with hand-made modules: what each gets, frame by frame.

#include "base/json.h"
#include "emu/radio/ether_node.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::radio::test {

using cosim::Time;
using protocols::MeshFrame;
using protocols::MeshKind;

inline constexpr Time kMs = cosim::kMillisecond;
inline constexpr std::uint64_t kBase = 0x0013A20000000100;

/// Address of station i unless a test gives another.
inline std::uint64_t address(std::size_t i) {
    return kBase + i;
}

class Air {
  public:
    struct Got {
        std::size_t station = 0;
        Time at = 0;
        cosim::RadioFrame radio;
        MeshFrame frame;
    };
    struct Fate {
        std::size_t station = 0;
        Time at = 0;
        RadioOutcome outcome;
    };

    explicit Air(std::vector<Position> places, double range = 30.0, double loss = 0.0, std::uint64_t seed = 1,
                 std::vector<cosim::CarriedFault> faults = {})
        : node(spec(places, range, loss, seed, std::move(faults))), settings(places.size()) {
        for (std::size_t i = 0; i < places.size(); ++i) {
            settings[i].on = true;
            settings[i].pan = 0x01B5;
            settings[i].address = address(i);
            settings[i].dbm = 1;
        }
    }

    void tell(std::size_t station) { push(station, encode(settings[station]), 0); }
    void tell_all() {
        for (std::size_t i = 0; i < settings.size(); ++i)
            tell(i);
    }
    /// Hands over a frame; returns its sequence.
    std::uint16_t send(std::size_t station, std::uint64_t to, std::vector<std::uint8_t> data,
                       std::uint8_t options = 0, std::uint8_t radius = 0) {
        MeshFrame frame;
        frame.target = to;
        frame.options = options;
        frame.radius = radius;
        frame.data = std::move(data);
        frame.sequence = ++sequence_;
        const auto octets = protocols::encode_mesh(frame);
        push(station, octets, air_time(octets.size()));
        return frame.sequence;
    }
    /// Runs to `until`, in steps of at most `step`; checks what was said about the future.
    void run(Time until, Time step = cosim::kNever) {
        while (now_ < until) {
            const Time next = step > until - now_ ? until : now_ + step;
            std::vector<cosim::Message> outbox;
            const Time earliest = node.earliest_output(0);
            const Time first_in = inbox_.empty() ? cosim::kNever : inbox_.front().time;
            node.advance(next, inbox_, outbox);
            inbox_.clear();
            for (const cosim::Message& message : outbox) {
                CHECK(message.time >= std::min(earliest, cosim::later(first_in, node.lookahead(0))));
                CHECK(message.time < next);
                take(message);
            }
            now_ = next;
        }
    }
    Time now() const { return now_; }
    nlohmann::json report() { return nlohmann::json::parse(node.finish()); }
    /// Data that a station got, in order.
    std::vector<std::vector<std::uint8_t>> data_of(std::size_t station) const {
        std::vector<std::vector<std::uint8_t>> found;
        for (const Got& one : got)
            if (one.station == station) found.push_back(one.frame.data);
        return found;
    }

    EtherNode node;
    std::vector<RadioSettings> settings;
    std::vector<Got> got;
    std::vector<Fate> fates;

  private:
    static EtherSpec spec(const std::vector<Position>& places, double range, double loss, std::uint64_t seed,
                          std::vector<cosim::CarriedFault> faults) {
        EtherSpec spec;
        spec.faults = std::move(faults);
        spec.seed = seed;
        spec.propagation.range_m = range;
        spec.propagation.loss = loss;
        for (std::size_t i = 0; i < places.size(); ++i)
            spec.stations.push_back({"m" + std::to_string(i), places[i]});
        return spec;
    }
    void push(std::size_t station, const std::vector<std::uint8_t>& octets, Time on_air) {
        cosim::RadioFrame frame;
        frame.start = now_;
        frame.duration = on_air;
        frame.octets = cosim::Octets(octets);
        frame.channel = settings[station].channel;
        inbox_.push_back({now_, static_cast<cosim::PortIndex>(station), frame});
    }
    void take(const cosim::Message& message) {
        const auto& radio = std::get<cosim::RadioFrame>(message.payload);
        if (radio.duration == 0) {
            const auto outcome = decode_outcome(radio.octets.view());
            REQUIRE(outcome);
            fates.push_back({message.port, message.time, *outcome});
            return;
        }
        CHECK(message.time == radio.start + radio.duration);
        CHECK(radio.duration == air_time(radio.octets.size()));
        const auto reading = protocols::decode_mesh(radio.octets.view());
        REQUIRE(reading.fault == protocols::MeshFault::None);
        got.push_back({message.port, message.time, radio, reading.frame});
    }

    std::vector<cosim::Message> inbox_;
    Time now_ = 0;
    std::uint16_t sequence_ = 0;
};

}  // namespace puckloop::radio::test
