#pragma once
// What a page of a run that goes on is sent: its state when that changed, and where robots and things went
// since the last message. One of them for each page.

#include "view/recording/recording.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>

namespace puckloop::view {

class Feed {
  public:
    /// Of the run: its state as text, and its epoch, which rises when what was recorded changes.
    struct Source {
        std::function<std::string()> state;
        std::function<std::uint64_t()> epoch;
    };
    /// What it is given must outlive it.
    Feed(const Recording& recording, Source run) : recording_(recording), run_(std::move(run)) {}

    /// All that is new, in parts; empty: nothing. A page that takes its messages slowly gets fewer and longer
    /// ones. A part is its kind (8 bits), the number of its bytes (32 bits) and these; little-endian:
    /// * State: that text. With another epoch, what was sent before does not hold, and the rest follows.
    /// * Name: 1 for a robot, 0 for a thing (8 bits), its number (16 bits), its name (UTF-8)
    /// * Rows: how many, n (32 bits); n numbers (16 bits); n times (s, 64-bit floats); then n values each
    ///   of x, y (m) and heading (rad), 32-bit floats
    /// At most Recording::kMostTail bytes of each file are read; the rest comes with the next message.
    std::string next();

    enum class Part : std::uint8_t { State = 1, Name = 2, Rows = 3 };

  private:
    void rows_of(bool robots, std::string& out);

    const Recording& recording_;
    Source run_;
    std::string state_;
    std::uint64_t epoch_ = 0;
    std::array<std::size_t, 2> read_{};                            // bytes of objects.csv and trajectory.csv
    std::array<std::map<std::string, std::uint16_t>, 2> numbers_;  // by name
    std::uint16_t known_ = 0;
};

}  // namespace puckloop::view
