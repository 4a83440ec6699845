#pragma once
// The line from a module to its host: bytes and breaks, one after another.

#include "cosim/core/message.h"
#include "emu/bluetooth/settings.h"

#include <deque>
#include <span>

namespace puckloop::bluetooth {

class SerialOut {
  public:
    static constexpr int kBitsToStop = 9;

    /// A clock of 12 MHz is divided to the exact rate.
    static cosim::Time bit_period_of(const SerialSettings& settings);

    void put(std::span<const std::uint8_t> bytes, cosim::Time now);
    /// The line is low for one character, and then high for one.
    void put_break(cosim::Time now);
    /// For what is put from now on; what waits keeps its own.
    void set(const SerialSettings& settings) { settings_ = settings; }
    const SerialSettings& settings() const { return settings_; }
    void clear() { waiting_.clear(); }

    /// When the next character begins; kNever if none waits.
    cosim::Time next() const { return waiting_.empty() ? cosim::kNever : free_; }
    cosim::UartFrame take();
    bool empty() const { return waiting_.empty(); }
    std::size_t waiting() const { return waiting_.size(); }
    std::uint64_t sent() const { return sent_; }

  private:
    struct Character {
        std::uint8_t data = 0;
        bool is_break = false;
        SerialSettings settings{};
    };
    void add(const Character& character, cosim::Time now);

    SerialSettings settings_{};
    std::deque<Character> waiting_;
    cosim::Time free_ = 0;  ///< the line is free from then on
    std::uint64_t sent_ = 0;
};

}  // namespace puckloop::bluetooth
