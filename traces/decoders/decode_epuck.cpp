#include "protocols/serial/epuck_serial.h"
#include "traces/decoders/decoders.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace puckloop::tools {

using namespace protocols;

namespace {

// Longer pauses inside a sensor record: the board was interrupted, and what follows is another record.
constexpr cosim::Time kLongestPause = 20 * cosim::kMillisecond;
constexpr std::size_t kSessionBytes = 1 + kEpuckConfigurationBytes;

template <std::size_t kSize>
std::span<const std::uint8_t, kSize> bytes_of(const ByteRun& run, std::size_t from = 0) {
    return std::span<const std::uint8_t, kSize>(run.bytes.data() + from, kSize);
}

DecodedFrame session(const ByteRun& run) {
    const EpuckConfiguration it = decode_configuration(bytes_of<kEpuckConfigurationBytes>(run, 1));
    DecodedFrame frame;
    frame.text = fmt::format("session wake-up {:02x} rab_range {} rab_enabled {}", run.bytes[0], it.rab_range,
                             it.rab_enabled);
    frame.fields = {{"record", "session"},
                    {"wake_up", run.bytes[0]},
                    {"rab_range", it.rab_range},
                    {"rab_enabled", it.rab_enabled}};
    return frame;
}

DecodedFrame actuators(const ByteRun& run) {
    const EpuckActuators it = decode_actuators(bytes_of<kEpuckActuatorBytes>(run));
    DecodedFrame frame;
    frame.text = fmt::format(
        "actuators left {} right {} ring {:02x} leds {:x} rab {:04x} ircom {}:{:02x} reset {}", it.left,
        it.right, it.ring_leds, it.other_leds, it.rab_data, it.ircom_enabled, it.ircom_data,
        it.reset >= ' ' && it.reset <= '~' ? std::string(1, static_cast<char>(it.reset))
                                           : fmt::format("{:02x}", it.reset));
    frame.fields = {{"record", "actuators"},
                    {"left", it.left},
                    {"right", it.right},
                    {"ring_leds", it.ring_leds},
                    {"other_leds", it.other_leds},
                    {"rab_data", it.rab_data},
                    {"ircom_enabled", it.ircom_enabled},
                    {"ircom_data", it.ircom_data},
                    {"reset", it.reset}};
    if (it.reset != kEpuckContinue && it.reset != kEpuckEnd)
        frame.errors.push_back(fmt::format("reset is {:02x}, neither N nor R", it.reset));
    return frame;
}

DecodedFrame sensors(const ByteRun& run) {
    const EpuckSensors it = decode_sensors(bytes_of<kEpuckSensorBytes>(run));
    DecodedFrame frame;
    frame.text =
        fmt::format("sensors proximity {} light {} accelerometer {} microphones {} battery {}",
                    fmt::join(it.proximity, " "), fmt::join(it.light, " "), fmt::join(it.accelerometer, " "),
                    fmt::join(it.microphones, " "), it.battery_ok ? "ok" : "low");
    if (it.rab_received)
        frame.text +=
            fmt::format(" rab {:04x} range {} bearing {:.3f}", it.rab_data, it.rab_range, it.rab_bearing);
    if (it.ircom_received)
        frame.text += fmt::format(" ircom {:02x} sensor {} range {:.1f} bearing {:.3f}", it.ircom_data,
                                  it.ircom_sensor, it.ircom_range, it.ircom_bearing);
    frame.fields = {{"record", "sensors"},
                    {"proximity", it.proximity},
                    {"light", it.light},
                    {"accelerometer", it.accelerometer},
                    {"microphones", it.microphones},
                    {"battery_ok", it.battery_ok},
                    {"rab_received", it.rab_received},
                    {"rab_data", it.rab_data},
                    {"rab_range", it.rab_range},
                    {"rab_bearing", it.rab_bearing},
                    {"ircom_received", it.ircom_received},
                    {"ircom_data", it.ircom_data},
                    {"ircom_sensor", it.ircom_sensor},
                    {"ircom_range", it.ircom_range},
                    {"ircom_bearing", it.ircom_bearing}};
    const std::string_view why = why_implausible(it);
    if (!why.empty()) frame.errors.push_back(fmt::format("implausible: {}", why));
    return frame;
}

}  // namespace

void EpuckDecoder::give(ByteRun& run, const std::string& from, DecodedFrame frame) {
    frame.begin = run.begin;
    frame.end = run.end;
    frame.link = link_;
    frame.from = from;
    frame.protocol = "epuck";
    frame.errors.insert(frame.errors.begin(), run.errors.begin(), run.errors.end());
    run = {};
    take_(frame);
}

void EpuckDecoder::give_rest(ByteRun& run, const std::string& from, const std::string& what) {
    if (run.empty()) return;
    DecodedFrame frame;
    frame.text = fmt::format("[{}]", hex_bytes(run.bytes));
    frame.fields = {{"record", "incomplete"}, {"bytes", hex_bytes(run.bytes)}};
    frame.errors.push_back(what);
    give(run, from, frame);
}

void EpuckDecoder::add(const cosim::TraceRow& row, const cosim::UartFrame& frame) {
    link_ = row.link;
    if (row.from.ends_with(".pic")) {
        board_name_ = row.from;
        if (linux_.bytes.size() > 0) {
            give_rest(
                linux_, linux_name_,
                fmt::format("{} bytes left when the main board answered: out of step", linux_.bytes.size()));
            expect_ = Expect::Actuators;
        }
        if (!board_.empty() && frame.start > board_.end + kLongestPause)
            give_rest(board_, board_name_,
                      fmt::format("{} of {} bytes, then silence", board_.bytes.size(), kEpuckSensorBytes));
        board_.add(row, frame, receive(from_board_line_, row, frame));
        from_board(row.from);
    } else {
        linux_name_ = row.from;
        linux_.add(row, frame, receive(from_linux_line_, row, frame));
        from_linux(row.from);
    }
}

void EpuckDecoder::from_board(const std::string& from) {
    if (board_.bytes.size() >= kEpuckSensorBytes) give(board_, from, sensors(board_));
}

void EpuckDecoder::from_linux(const std::string& from) {
    if (expect_ == Expect::Session && linux_.bytes.size() >= kSessionBytes) {
        give(linux_, from, session(linux_));
        expect_ = Expect::Actuators;
    } else if (expect_ == Expect::Actuators && linux_.bytes.size() >= kEpuckActuatorBytes) {
        const DecodedFrame frame = actuators(linux_);
        if (frame.fields.at("reset") == kEpuckEnd) expect_ = Expect::Session;
        give(linux_, from, frame);
        give_rest(board_, board_name_,
                  fmt::format("{} of {} bytes when Linux sent its next record", board_.bytes.size(),
                              kEpuckSensorBytes));
    }
}

void EpuckDecoder::end() {
    const std::size_t wanted = expect_ == Expect::Session ? kSessionBytes : kEpuckActuatorBytes;
    give_rest(linux_, linux_name_,
              fmt::format("{} of {} bytes, then the end of the trace", linux_.bytes.size(), wanted));
    give_rest(
        board_, board_name_,
        fmt::format("{} of {} bytes, then the end of the trace", board_.bytes.size(), kEpuckSensorBytes));
}

}  // namespace puckloop::tools
