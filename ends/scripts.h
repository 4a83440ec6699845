#pragma once
// The bench's script files: bytes for a UART, a bus master on I2C, values for named inputs.
// Lines may stand in any order; those of one time keep the order of the file.

#include "cosim/core/signal_info.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace puckloop::exec {

/// `<time_s> <hex bytes>`: the first start bit falls at `time`, or when the line before it has been sent.
struct UartScriptLine {
    cosim::Time time = 0;
    std::vector<std::uint8_t> bytes;
};
std::vector<UartScriptLine> parse_uart_script(std::string_view file, std::string_view text);

/// One thing that a master does of itself, without regard to what the slave answers.
struct I2cRawStep {
    enum class Kind : std::uint8_t { Start, Write, Read, Stop } kind = Kind::Stop;
    std::uint8_t byte = 0;     ///< of Start and Write
    bool acknowledge = false;  ///< of Read
    int clocks = 9;            ///< 1 to 7: broken off after so many, by the START or STOP that follows
};

/// `<time_s> w <addr> <hex bytes>` or `<time_s> r <addr> <register> <count>`, addresses of 7 bits written
/// 0x20 (without 0x they are an error), of 10 bits ten:0x2a5; `-` for the register: none is written, the
/// device goes on from where it is. Or `<time_s> raw <steps>`: sXX a START and a byte, wXX a byte
/// written, r and n a byte read with and without acknowledge, p a STOP; /N after it breaks it off after N
/// clocks.
struct I2cScriptLine {
    int line = 0;  ///< in the file, from 1
    cosim::Time time = 0;
    std::uint16_t address = 0;
    bool ten_bits = false;
    bool read = false;
    std::vector<I2cRawStep> raw{};                ///< not empty: nothing else counts
    std::vector<std::uint8_t> bytes;              ///< of a write
    std::optional<std::uint8_t> register_number;  ///< of a read: written first, then a repeated START
    int count = 0;                                ///< of a read: bytes, 1 to 256
};
std::vector<I2cScriptLine> parse_i2c_script(std::string_view file, std::string_view text);

/// `<time_s> <signal> <value>`: one of the board's named inputs takes a value within its range.
/// `<time_s> reset 1` presses the reset button of a target that has no signal of that name.
struct StimulusLine {
    static constexpr std::uint16_t kReset = 0xFFFF;  ///< in place of a signal
    cosim::Time time = 0;
    std::uint16_t signal = 0;
    double value = 0.0;
};
std::vector<StimulusLine> parse_stimulus(std::string_view file, std::string_view text,
                                         std::span<const cosim::SignalInfo> signals);

}  // namespace puckloop::exec
