// What the I2C bus reports of itself: its devices, counters and warnings.

#include "base/json.h"
#include "base/text/times_text.h"
#include "cosim/i2c/i2c_bus.h"
#include "cosim/i2c/i2c_figures.h"

#include <fmt/format.h>

namespace puckloop::cosim {

namespace {
// An answer that has been awaited for so long at the end of a run is a bus that hangs.
constexpr Time kHangs = 100 * kMillisecond;

}  // namespace

std::string I2cBusNode::device_list() const {
    std::string list;
    for (const auto& slave : slaves_)
        list += fmt::format("{}{}", list.empty() ? "" : ", ", slave->name());
    for (const auto& device : options_.devices)
        list += fmt::format("{}{}", list.empty() ? "" : ", ", device.name);
    return list;
}

std::vector<std::string> I2cBusNode::warnings() const {
    std::vector<std::string> lines;
    // A main board reports it itself.
    for (const auto& [who, times] : counters_.absent)
        if (options_.masters[who.first].waits)
            lines.push_back(fmt::format("{} addressed 0x{:02x} {} and nobody acknowledged",
                                        options_.masters[who.first].name, who.second, times_text(times)));
    for (const auto& [address, crowd] : crowds_)
        lines.push_back(fmt::format("0x{:02x} was acknowledged by {} together, {}: bytes read are "
                                    "the and of what each sends",
                                    address, crowd.names, times_text(crowd.times)));
    if (counters_.stuck > 0)
        lines.push_back(
            fmt::format("the bus was stuck {}, {:.3f} ms in all{}: {} held SCL low until the master gave up",
                        times_text(counters_.stuck),
                        to_seconds(stuck_for_ + (holders_.empty() ? 0 : now_ - stuck_since_)) * 1e3,
                        holders_.empty() ? "" : " and still is", stuck_names_));
    if (pending_ && now_ - pending_->phase.start > kHangs) {
        std::string names;
        for (const PortIndex device : pending_->open)
            names += (names.empty() ? "" : ", ") + device_name(device);
        lines.push_back(fmt::format("SCL is held low by {} since {:.6f} s, and the master waits for it",
                                    names, to_seconds(pending_->phase.start)));
    }
    return lines;
}

std::string I2cBusNode::finish() {
    faults_.conclude(now_);
    log_.end(now_, fmt::format("{} transfers, {} bytes written, {} read, {} not acknowledged, bus lost {}",
                               counters_.transfers, counters_.bytes_written, counters_.bytes_read,
                               counters_.not_acknowledged, times_text(counters_.lost)));
    std::string devices;
    for (const auto& slave : slaves_)
        devices += fmt::format("{}\"{}\":{}", devices.empty() ? "" : ",", slave->name(), slave->report());
    std::string warning_list;
    for (const std::string& line : warnings())
        warning_list += fmt::format("{}\"{}\"", warning_list.empty() ? "" : ",", line);
    return fmt::format(
        R"({{"transfers":{},"not_acknowledged":{},"lost":{},"bytes_written":{},"bytes_read":{},)"
        R"("stretched":{},"longest_stretch_us":{:.3f},"stuck":{},"devices":{{{}}},"warnings":[{}]{}}})",
        counters_.transfers, counters_.not_acknowledged, counters_.lost, counters_.bytes_written,
        counters_.bytes_read, counters_.stretched, microseconds(counters_.longest_stretch), counters_.stuck,
        devices, warning_list,
        faults_.empty() ? "" : ",\"faults\":" + fault_results(faults_.carried(), now_).dump());
}

}  // namespace puckloop::cosim
