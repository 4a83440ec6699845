#include "tests/firmware/rab_bench.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

namespace puckloop::firmware {

namespace {

constexpr std::uint8_t kAddress = 0x20;
constexpr double kReadTime = 450e-6;  // s at 100 kHz with what the original firmware stretches
constexpr int kMaximumChips = 90;

}  // namespace

Levels levels(std::initializer_list<std::pair<int, int>> peaks) {
    Levels out{};
    for (const auto& [sensor, peak] : peaks)
        out[static_cast<std::size_t>(sensor)] = peak;
    return out;
}

std::string lit_part(std::string chips) {
    while (chips.back() == '0')
        chips.pop_back();
    return chips;
}

void RabBench::write(double time, std::vector<std::uint8_t> bytes) {
    script_.push_back({.line = static_cast<int>(script_.size()) + 1,
                       .time = cosim::from_seconds(time),
                       .address = kAddress,
                       .bytes = std::move(bytes),
                       .register_number = 0});
}

void RabBench::read(double time, int number, int count) {
    script_.push_back({.line = static_cast<int>(script_.size()) + 1,
                       .time = cosim::from_seconds(time),
                       .address = kAddress,
                       .read = true,
                       .bytes = {},
                       .register_number = static_cast<std::uint8_t>(number),
                       .count = count});
}

double RabBench::poll(double time) {
    for (int number = 0; number < static_cast<int>(kPollReads); ++number)
        read(time + number * kReadTime, number);
    return time + kReadTime * kPollReads;
}

void RabBench::signal(double time, const std::string& name, double value) {
    const auto id = cosim::find_signal(rig.bench().target().signals(), name);
    REQUIRE(id.has_value());
    stimulus_.push_back({cosim::from_seconds(time), *id, value});
}

double RabBench::light(double time, const std::string& chips, const Levels& peaks, const Light& light) {
    char before = '0';
    for (std::size_t i = 0; i <= chips.size(); ++i) {
        const char now = i < chips.size() ? chips[i] : '0';
        if (now == before) continue;
        before = now;
        const double edge = time + static_cast<double>(i) * light.chip;
        for (std::size_t sensor = 0; sensor < peaks.size(); ++sensor) {
            if (peaks[sensor] == 0) continue;
            const std::string number = std::to_string(sensor + 1);
            const bool on = now == '1';
            signal(edge, "peak" + number, on ? peaks[sensor] : 0);
            signal(edge + (on ? light.on_delay : light.off_delay), "demod" + number, on ? 1 : 0);
        }
    }
    return time + static_cast<double>(chips.size()) * light.chip;
}

void RabBench::run(double until) {
    const auto earlier = [](const auto& a, const auto& b) { return a.time < b.time; };
    std::stable_sort(script_.begin(), script_.end(), earlier);
    std::stable_sort(stimulus_.begin(), stimulus_.end(), earlier);
    rig.bench().master(script_, master);
    rig.bench().stimulate(stimulus_);
    rig.run_to(until);
    for (const auto& read : bus().reads)
        reads_.push_back(read.bytes);
}

std::vector<SentFrame> RabBench::sent(int emitter) const {
    std::vector<SentFrame> frames;
    std::vector<exec::Rig::Change> edges = rig.changes("emitter" + std::to_string(emitter));
    // A frame's darkness lasts two chips at most; the next frame's begins later.
    for (std::size_t first = 0; first < edges.size();) {
        if (edges[first].value == 0) {
            ++first;
            continue;
        }
        std::size_t last = first;
        while (last + 1 < edges.size() && edges[last + 1].time_s - edges[last].time_s < 8.5 * kChip &&
               (edges[last].value == 1 || edges[last + 1].time_s - edges[last].time_s < 2.5 * kChip))
            ++last;
        SentFrame frame;
        frame.start = edges[first].time_s;
        double count = 0;
        for (std::size_t i = first; i < last; ++i) {
            const double length = edges[i + 1].time_s - edges[i].time_s;
            const auto chips = static_cast<int>(std::lround(length / kChip));
            REQUIRE(chips < kMaximumChips);
            frame.chips.append(static_cast<std::size_t>(chips), edges[i].value == 1 ? '1' : '0');
            count += chips;
            frame.jitter = std::max(frame.jitter, std::abs(length - chips * kChip));
        }
        frame.chip = (edges[last].time_s - frame.start) / count;
        frames.push_back(frame);
        first = last + 1;
    }
    return frames;
}

Message message(const RabBench& bench, std::size_t first) {
    const auto& reads = bench.reads();
    REQUIRE(reads.size() >= first + kPollReads);
    const auto byte = [&](std::size_t number) { return static_cast<unsigned>(reads[first + number][0]); };
    Message out;
    out.there = byte(0) == 1;
    out.data = byte(10) << 24 | byte(11) << 16 | byte(1) << 8 | byte(2);
    out.bearing = static_cast<std::int16_t>(byte(3) << 8 | byte(4));
    out.range = static_cast<int>(byte(5) << 8 | byte(6));
    out.peak = static_cast<int>(byte(7) << 8 | byte(8));
    out.sensor = static_cast<int>(byte(9));
    return out;
}

}  // namespace puckloop::firmware
