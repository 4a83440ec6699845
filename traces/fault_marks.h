#pragma once
// Faults that leave no mark in a trace: those of I2C buses, of the air and the light between nodes, of boards
// and programs. What they did is in the trace, that it was a fault only in faults.csv beside it. (Rows of
// UART and radio links have a column for their own.)
//
// faults.csv has the first 1000 firings of each fault.

#include "traces/recorded_trace.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::tools {

struct FaultMark {
    cosim::Time time = 0;
    std::string place, kind, what;  ///< "robot0.i2c", "flip", "linux 0x60 byte 1 read bit 3"
    std::optional<int> bit{};       ///< of a byte, 7 the first on the wire: where its master lost the bus
    /// While a line is held low.
    std::optional<cosim::Time> low_from{}, until{};

    /// "flip: linux 0x60 byte 1 read bit 3"
    std::string text() const { return kind + ": " + what; }
};

class FaultMarks {
  public:
    /// None.
    FaultMarks() = default;
    /// Those that the selection wants, from the faults.csv of the same run; none if there is no such file.
    /// Reads the trace once if there are any of an I2C bus. Throws InputError naming file and line.
    explicit FaultMarks(const RecordedTrace& trace);

    bool empty() const { return on_bytes_.empty() && alone_.empty(); }
    /// Of the byte that begins at `start` on the bus.
    std::vector<const FaultMark*> of_byte(const std::string& bus, cosim::Time start) const;

  private:
    friend class FaultMarkCursor;
    std::multimap<std::pair<std::string, cosim::Time>, FaultMark> on_bytes_;
    std::vector<FaultMark> alone_;  // of no byte in the trace
};

/// Goes through marks as time goes on.
class FaultMarkCursor {
  public:
    enum Which : std::uint8_t { Alone, All };
    /// `marks` must outlive it.
    explicit FaultMarkCursor(const FaultMarks& marks, Which which = Alone);
    /// The next one up to `time`; nullptr: none.
    const FaultMark* next(cosim::Time time) {
        return at_ < marks_.size() && marks_[at_]->time <= time ? marks_[at_++] : nullptr;
    }

  private:
    std::vector<const FaultMark*> marks_;
    std::size_t at_ = 0;
};

}  // namespace puckloop::tools
