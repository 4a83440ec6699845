#pragma once
// The log of an I2C bus: who spoke to whom first, and what went wrong, the first time and then at powers of
// two.

#include "base/logs/node_log.h"
#include "cosim/core/message.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::cosim {

/// Times are those at which the bus handled the event; calls in their order.
class I2cLog {
  public:
    /// `masters`: port names by index. An empty path is no log. Throws RunError as NodeLog does.
    I2cLog(const std::string& path, std::vector<std::string> masters);

    /// First line: the bus as it is set up.
    void begin(const std::string& devices, double nominal_hertz);
    /// `master` sent a Start with this address byte and owns the bus.
    void addressed(Time now, PortIndex master, std::uint8_t byte);
    /// The bus answered the owner's last Start, Write or Read; `stretched`: later than without the device.
    void answered(Time now, PortIndex master, const I2cPhase& answer, bool to_start, bool stretched);
    /// `master` was sent BusLost for a phase of its own.
    void lost(Time now, PortIndex master, const I2cPhase& phase);
    /// Several devices acknowledged one Start, for the `times`th time.
    void crowded(Time now, std::uint8_t byte, const std::string& names, std::uint64_t times);
    /// A master gave up while these devices hold SCL low; they let go.
    void stuck(Time now, const std::string& names, std::uint64_t times);
    void released(Time now, const std::string& names);
    void end(Time now, const std::string& summary);

    /// What was counted, without the lines: they are kept back from mark() on, as NodeLog does.
    template <class Archive>
    void state(Archive& archive) {
        archive(pairs_, losses_, address_);
    }
    void mark() { log_.mark(); }
    void rewind() { log_.rewind(); }
    void settle() { log_.settle(); }

  private:
    struct Pair {  // of a master and an address
        std::uint64_t transfers = 0, absent = 0, refused_bytes = 0, stretches = 0;
        Time longest_stretch = 0;
    };
    void write(Time now, const std::string& text) { log_.line(to_seconds(now), text); }

    NodeLog log_;
    std::vector<std::string> masters_;
    std::map<std::pair<PortIndex, std::uint8_t>, Pair> pairs_;
    std::map<PortIndex, std::uint64_t> losses_;
    std::uint8_t address_ = 0;  // 7 bits, of the transfer under way
};

}  // namespace puckloop::cosim
