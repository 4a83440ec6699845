#include "tests/rab_board/rab_rig.h"

#include "emu/rab_board/signals.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>

namespace puckloop::rab {

namespace {
constexpr int kRange = 5, kBearing = 3, kPeakHigh = 7, kSensor = 9;
constexpr double kBootSeconds = 0.1;  // 85 ms with four-digit baselines
}  // namespace

RabRig::RabRig(const std::string& image_file, double i2c_hertz) : rig_("rab", image_file) {
    master_.clock_hertz = i2c_hertz;
}

void RabRig::ambient(int counts) {
    ambient_ = counts;
    for (int i = 1; i <= kSensorCount; ++i)
        rig_.set(fmt::format("peak{}", i), counts);
}

void RabRig::boot() {
    run_to(kBootSeconds);
    rig_.take(2);
    clear();
}

void RabRig::finish_script() {
    const exec::I2cScriptReport& report = bus();
    while (report.played < report.lines && !report.stuck_since)
        rig_.run_for(5e-6);
    REQUIRE_FALSE(report.stuck_since);
}

void RabRig::play(const std::string& script) {
    rig_.bench().master(exec::parse_i2c_script("test", script), master_);
    finish_script();
}

const exec::I2cScriptReport& RabRig::write(int number, const std::vector<std::uint8_t>& bytes) {
    std::string line = fmt::format("{:.12f} w 0x20 {:02x}", now_s(), number);
    for (const std::uint8_t byte : bytes)
        line += fmt::format(" {:02x}", byte);
    play(line + "\n");
    return bus();
}

std::vector<std::uint8_t> RabRig::read(int number, int count) {
    play(fmt::format("{:.12f} r 0x20 {} {}\n", now_s(), number, count));
    REQUIRE(bus().reads.size() == 1);
    return bus().reads[0].bytes;
}

std::vector<std::uint8_t> RabRig::read_on(int count) {
    play(fmt::format("{:.12f} r 0x20 - {}\n", now_s(), count));
    REQUIRE(bus().reads.size() == 1);
    return bus().reads[0].bytes;
}

void RabRig::send(int size, std::uint32_t payload) {
    constexpr int kRegisters[] = {14, 20, 19, 13};  // of byte 0, 1, 2, 3
    if (size < 32) write(13, {0});                  // the only one that clears the rest
    for (int byte = size / 8 - 1; byte >= 0; --byte)
        write(kRegisters[byte], {static_cast<std::uint8_t>(payload >> (8 * byte))});
}

void RabRig::later(double time_s, const std::string& signal, double value) {
    const auto id = cosim::find_signal(signals(), signal);
    REQUIRE(id.has_value());
    rig_.bench().stimulate({{cosim::from_seconds(time_s), *id, value}});
}

void RabRig::show(double time_s, const std::string& chips, const std::vector<Seen>& sensors, double chip_s,
                  double on_s, double off_s) {
    std::vector<exec::StimulusLine> lines;
    char before = '0';
    for (std::size_t i = 0; i <= chips.size(); ++i) {
        const char chip = i < chips.size() ? chips[i] : '0';
        if (chip == before) continue;
        before = chip;
        const bool on = chip == '1';
        const cosim::Time edge =
            cosim::from_seconds(time_s + static_cast<double>(i) * chip_s + (on ? on_s : off_s));
        for (const Seen& seen : sensors) {
            lines.push_back({edge, static_cast<SignalId>(kDemodulator + seen.sensor), on ? 1.0 : 0.0});
            lines.push_back({edge, static_cast<SignalId>(kPeak + seen.sensor),
                             static_cast<double>(ambient_ + (on ? seen.peak : 0))});
        }
    }
    rig_.bench().stimulate(lines);
}

std::vector<Burst> RabRig::bursts(int emitter) const {
    std::vector<Burst> found;
    double last = 0;
    bool on = false;
    for (const exec::Rig::Change& change : changes(fmt::format("emitter{}", emitter))) {
        const double run = change.time_s - last;
        if (!on && (found.empty() || run > 2.6 * kChip))
            found.push_back({{}, change.time_s, 0, 0});
        else
            found.back().chips.append(static_cast<std::size_t>(std::lround(run / kChip)), on ? '1' : '0');
        on = change.value > 0;
        last = found.back().last_edge_s = change.time_s;
    }
    for (Burst& burst : found)
        burst.chip_s = (burst.last_edge_s - burst.start_s) / static_cast<double>(burst.chips.size());
    return found;
}

std::optional<RabRig::Message> RabRig::poll() {
    if (get(0) != 1) return std::nullopt;
    Message message;
    message.data = static_cast<std::uint32_t>(get(10)) << 24 | static_cast<std::uint32_t>(get(11)) << 16 |
                   static_cast<std::uint32_t>(get16(1));
    message.bearing = static_cast<std::int16_t>(get16(kBearing));
    message.range = get16(kRange);
    message.peak = get16(kPeakHigh);
    message.sensor = get(kSensor);
    return message;
}

std::string visible(std::string chips) {
    chips.erase(chips.find_last_of('1') + 1);
    return chips;
}

}  // namespace puckloop::rab
