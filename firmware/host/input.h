#pragma once
// What a drawn or fuzzed input means: bytes that say, one after the other, what reaches a robot, and when.

#include "cosim/core/message.h"

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace hosted {

class Input {
  public:
    explicit Input(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
    bool empty() const { return bytes_.empty(); }
    /// 0 behind the end.
    std::uint8_t byte() {
        if (bytes_.empty()) return 0;
        const std::uint8_t first = bytes_.front();
        bytes_ = bytes_.subspan(1);
        return first;
    }

  private:
    std::span<const std::uint8_t> bytes_;
};

/// A character 8N1 whose stop bit begins at `now`, of a sender whose bit time is `bit`.
puckloop::cosim::UartFrame character(std::uint8_t data, puckloop::cosim::Time now, puckloop::cosim::Time bit);

/// How long, in microseconds, each half period of an IRcom word is, light and dark in turn, the first one
/// lit: twelve symbols, bit 11 first.
std::vector<double> ircom_halves(std::uint16_t symbols, double scale);
/// The symbols of a word as it is sent.
std::uint16_t ircom_symbols(std::uint8_t word);

/// One input from power-up to its end, on this firmware; each of epuck.cpp, rab.cpp and tam.cpp has one.
void run_input(std::span<const std::uint8_t> bytes);
/// What the last run_input() saw the firmware do, to compare runs by: a hash, and how much there was of it.
struct Seen {
    std::uint64_t hash = 14695981039346656037ull;  ///< FNV-1a
    std::uint64_t bytes_sent = 0;                  ///< on its serial lines
    std::uint64_t other = 0;                       ///< I2C answers, changes of outputs
    void add(std::uint64_t value) { hash = (hash ^ value) * 1099511628211ull; }
};
const Seen& seen();

}  // namespace hosted
