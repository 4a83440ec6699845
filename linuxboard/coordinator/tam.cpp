#include "linuxboard/coordinator/tam.h"

#include <cstdlib>
#include <fmt/format.h>

namespace puckloop::coordinator {

namespace {

// The first byte of a radio payload (TAM fact sheet, section 7).
constexpr std::uint8_t kReport = 0x00;
constexpr std::uint8_t kSetLeds = 0x0A, kWriteRobot = 0x0C, kShutDown = 0x0D;
constexpr std::size_t kReportSize = 8;
constexpr int kBatteryStep = 33;  // mV: one count of the TAM's converter, which is its noise

std::string hex(std::uint8_t byte) {
    return fmt::format("{:02x}", byte);
}

}  // namespace

std::optional<Report> parse_report(const protocols::XBeeBytes& payload) {
    if (payload.size() != kReportSize || payload[0] != kReport) return std::nullopt;
    return Report{
        {payload[1], payload[2], payload[3]}, payload[4] != 0, payload[5] | payload[6] << 8, payload[7]};
}

void Tam::move_to(std::uint64_t address) {
    address_ = address;
    report_.reset();
    written_.reset();
    set_leds_ = write_robot_ = {};
    unsure_ = false;
}

void Tam::take_report(const Report& report, double now) {
    const std::optional<Report> before = report_;
    report_ = report;
    heard_ = now;
    if (lost_) note("back", "");
    lost_ = false;
    if (!before || before->leds != report.leds) note("leds", to_text(report.leds));
    if (!before || before->robot != report.robot) note("robot", report.robot ? "in" : "out");
    if (!before || before->robot_byte != report.robot_byte) note("heard", hex(report.robot_byte));
    if (std::abs(report.battery_mv - battery_noted_) > kBatteryStep) {
        battery_noted_ = report.battery_mv;
        note("battery", std::to_string(report.battery_mv), "mV");
    }
    // A TAM that lost a colour it had was restarted, and has forgotten the byte too.
    const bool asked = set_leds_.outstanding && report.leds == color_sent_;
    if (before && before->leds != report.leds && report.leds == kOff && !asked) written_.reset();
    set_leds_.outstanding = unsure_ = false;
}

void Tam::take_status(std::uint8_t id, std::uint8_t delivery, double now) {
    const bool is_byte = write_robot_.outstanding && write_robot_.id == id;
    const bool is_leds = set_leds_.outstanding && set_leds_.id == id;
    if (is_byte) write_robot_.outstanding = false;
    if (is_byte && delivery == 0) written_ = byte_sent_;
    if (delivery == 0) return;
    note("not_delivered", hex(delivery), is_byte ? "write_robot" : "set_leds");
    if (is_byte) write_robot_.not_before = now + kRetry;
    if (is_leds) {
        set_leds_.outstanding = false;
        set_leds_.not_before = now + kRetry;
    }
}

void Tam::pass_time(double now) {
    if (set_leds_.outstanding && now - set_leds_.since >= kSetLedsTimeout) {
        set_leds_.outstanding = false;
        note("timeout", "set_leds");
    }
    if (write_robot_.outstanding && now - write_robot_.since >= kWriteRobotTimeout) {
        write_robot_.outstanding = false;
        note("timeout", "write_robot");
    }
    if (report_ && !lost_ && now - heard_ >= kSilence) {
        lost_ = true;
        note("lost", "");
    }
}

std::optional<protocols::XBeeBytes> Tam::next_request(double now) const {
    if (shut_down_) return protocols::XBeeBytes{kShutDown};
    if (color_ && (unsure_ || !shows(*color_)) && !set_leds_.outstanding && now >= set_leds_.not_before)
        return protocols::XBeeBytes{kSetLeds, color_->red, color_->green, color_->blue};
    if (byte_ && byte_ != written_ && !write_robot_.outstanding && now >= write_robot_.not_before)
        return protocols::XBeeBytes{kWriteRobot, *byte_};
    return std::nullopt;
}

void Tam::sent(const protocols::XBeeBytes& payload, std::uint8_t id, double now) {
    switch (payload[0]) {
    case kSetLeds:
        color_sent_ = {payload[1], payload[2], payload[3]};
        unsure_ = true;
        set_leds_ = {true, id, now, 0};
        note("set_leds", to_text(color_sent_));
        break;
    case kWriteRobot:
        byte_sent_ = payload[1];
        write_robot_ = {true, id, now, 0};
        note("write_robot", hex(byte_sent_));
        break;
    default:
        shut_down_ = false;
        note("shut_down", "");
    }
}

}  // namespace puckloop::coordinator
