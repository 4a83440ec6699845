#pragma once
// The parameters of one module: those in force, those queued by 09 frames, and what is in its flash (WR).

#include "emu/xbee/at_table.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::xbee {

class Settings {
  public:
    Settings() : now_(factory()), queued_(now_), flash_(now_) {}

    std::uint32_t operator[](At place) const { return now_.numbers[place]; }
    const std::string& node_identifier() const { return now_.identifier; }
    std::uint64_t destination() const { return std::uint64_t{now_.numbers[kDH]} << 32 | now_.numbers[kDL]; }

    /// An answer's value: the parameter in force, or as queued, high octet first. `place` is in the table.
    protocols::XBeeBytes read(std::size_t place, bool queued = false) const;
    /// Queues a value; returns an AT status. A number may have fewer octets than the parameter.
    std::uint8_t write(std::size_t place, const protocols::XBeeBytes& value);
    std::uint8_t write_identifier(const protocols::XBeeBytes& value);
    /// Queues a destination (DN in command mode).
    void write_destination(std::uint64_t address);
    /// What is queued is in force (AC, WR, an 08 frame).
    void apply() { now_ = queued_; }
    /// Into flash (WR).
    void save() { flash_ = now_; }
    /// All to factory values, queued (RE).
    void restore() { queued_ = factory(); }
    /// After reset: what is in flash.
    void reset() { now_ = queued_ = flash_; }

  private:
    struct Values {
        std::vector<std::uint32_t> numbers;  ///< as at_table()
        std::string identifier;
    };
    static Values factory();

    Values now_, queued_, flash_;
};

}  // namespace puckloop::xbee
