#include "cosim/i2c/i2c_log.h"

#include "base/text/times_text.h"
#include "cosim/i2c/i2c_figures.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::cosim {

I2cLog::I2cLog(const std::string& path, std::vector<std::string> masters)
    : log_(path), masters_(std::move(masters)) {}

void I2cLog::begin(const std::string& devices, double nominal_hertz) {
    write(0, fmt::format("bus at {:.6g} kHz; masters {}; devices {}", nominal_hertz / 1e3,
                         fmt::join(masters_, ", "), devices.empty() ? "none" : devices));
}

void I2cLog::addressed(Time now, PortIndex master, std::uint8_t byte) {
    if (!log_.is_open()) return;
    address_ = static_cast<std::uint8_t>(byte >> 1);
    if (++pairs_[{master, address_}].transfers == 1)
        write(now, fmt::format("{}: first transfer with 0x{:02x}, a {}", masters_[master], address_,
                               (byte & kReadBit) != 0 ? "read" : "write"));
}

void I2cLog::answered(Time now, PortIndex master, const I2cPhase& answer, bool to_start, bool stretched) {
    if (!log_.is_open()) return;
    const bool refused = answer.kind == I2cPhaseKind::Acknowledge && answer.ack == 0;
    if (!refused && !stretched) return;
    Pair& pair = pairs_[{master, address_}];
    if (refused && to_start && is_milestone(++pair.absent))
        write(now, fmt::format("{}: nobody acknowledges 0x{:02x}{}", masters_[master], address_,
                               so_far_text(pair.absent)));
    if (refused && !to_start && is_milestone(++pair.refused_bytes))
        write(now, fmt::format("{}: 0x{:02x} does not acknowledge byte 0x{:02x}{}", masters_[master],
                               address_, answer.byte, so_far_text(pair.refused_bytes)));
    if (!stretched) return;
    pair.longest_stretch = std::max(pair.longest_stretch, answer.stretch);
    if (is_milestone(++pair.stretches))
        write(now, fmt::format("{}: 0x{:02x} stretches the clock by {:.3f} us{}", masters_[master], address_,
                               microseconds(answer.stretch), so_far_text(pair.stretches)));
}

void I2cLog::lost(Time now, PortIndex master, const I2cPhase& phase) {
    if (!log_.is_open() || !is_milestone(++losses_[master])) return;
    const std::string what = phase.kind == I2cPhaseKind::Start
                                 ? fmt::format("START for 0x{:02x}", phase.byte >> 1)
                                 : std::string("byte sent without owning it");
    write(now, fmt::format("{}: loses the bus, {}{}", masters_[master], what, so_far_text(losses_[master])));
}

void I2cLog::crowded(Time now, std::uint8_t byte, const std::string& names, std::uint64_t times) {
    if (!is_milestone(times)) return;
    write(now,
          fmt::format("0x{:02x} is acknowledged by {} together{}", byte >> 1, names, so_far_text(times)));
}

void I2cLog::stuck(Time now, const std::string& names, std::uint64_t times) {
    if (!is_milestone(times)) return;
    write(now, fmt::format("stuck: the master gave up, {} holds SCL low{}", names, so_far_text(times)));
}

void I2cLog::released(Time now, const std::string& names) {
    write(now, fmt::format("{} lets SCL go", names));
}

void I2cLog::end(Time now, const std::string& summary) {
    log_.settle();
    if (!log_.is_open()) return;
    for (const auto& [key, pair] : pairs_) {
        const auto& [master, address] = key;
        std::string text = fmt::format("{} with 0x{:02x}: {} transfers, {} not acknowledged",
                                       masters_[master], address, pair.transfers, pair.absent);
        if (pair.refused_bytes > 0) text += fmt::format(", {} bytes refused", pair.refused_bytes);
        if (pair.stretches > 0)
            text += fmt::format(", {} stretches, the longest {:.3f} us", pair.stretches,
                                microseconds(pair.longest_stretch));
        write(now, text);
    }
    write(now, "end: " + summary);
}

}  // namespace puckloop::cosim
