#pragma once
// The levels of every wire that a trace knows, drawn exactly from the recorded frames.
//
// UART: start bit, data, parity, stop and break in the sender's bit time. What a fault kept from arriving is
// not drawn; what it changed is drawn as it arrived, and marked on a line of its own. Where frames of one
// line overlap (a duplicate) the line is low when either is.
// I2C, in sixteenths of the master's clock from the start of a byte: SCL is low for 0..8 and high for 8..16
// of each of nine clocks; SDA changes at 4. A START takes the low half of its first clock: SDA high at 1, SCL
// high at 2, SDA low at 4 (the condition), SCL low at 6, first bit at 7. A STOP: SDA low at 4, SCL high at 8,
// SDA high at 12. A device stretches the low half of the ninth clock, where it was written to, or of the
// first, where it is read. Between the bytes of a transfer SCL is low. Deviations: a START that is repeated
// takes longer on a real bus; who pulls the lines low is not drawn; of a byte without answer nine clocks, as
// far as the next START. Of a byte at which a fault took the bus from its master the bits up to the one that
// was lost, and the line as it is held from then on; what a master lost to another one is that one's byte.
// A fault that leaves no mark in the trace (fault_marks.h) is on a line of its place: for the byte that it
// harmed, or for 10 us.
// CAN: can_frames.h; the line of a bus is low where it is dominant, as at a controller's RX pin.
// Signals with no other values than 0 and 1 are lines; a radio's line is high while it transmits.

#include "cosim/trace/trace_row.h"
#include "traces/fault_marks.h"
#include "traces/i2c_transfers.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::tools {

struct Line {
    enum class Kind : std::uint8_t { Uart, Scl, Sda, Can, Pin, OnAir, Fault };
    std::string scope;  ///< link, or bus
    std::string from;   ///< node; empty for a bus
    std::string name;   ///< "line", "scl", the signal's name, "fault"
    Kind kind = Kind::Uart;
    bool logic = true;  ///< false: a signal that had other values than 0 and 1

    bool rests_high() const {
        return kind == Kind::Uart || kind == Kind::Scl || kind == Kind::Sda || kind == Kind::Can;
    }
    /// "robot0.uart/robot0.pic", "robot0.i2c/scl", "robot0.world/robot0.pic/body_led"
    std::string full_name() const;
};

/// A line leaves its level of rest for one more reason (+1), or for one less (-1).
struct LineEvent {
    std::size_t line = 0;
    int change = 0;
};

class LineRenderer {
  public:
    /// Times are not in order, but never before those of the rows by more than how_late().
    using Emit = std::function<void(cosim::Time, const LineEvent&)>;
    /// `marks` must outlive it.
    explicit LineRenderer(Emit emit, const FaultMarks& marks = kNoMarks);

    void add(const cosim::TraceRow& row);
    void end();

    /// In the order of their first rows.
    const std::vector<Line>& lines() const { return lines_; }
    cosim::Time how_late() const { return late_; }
    /// The fastest UART bit or I2C clock seen; kNever: none.
    cosim::Time shortest_bit() const { return shortest_; }
    /// Time of the last row or event, whichever is later.
    cosim::Time last() const { return last_; }

  private:
    struct Wires {  // of one I2C bus
        std::size_t scl = 0, sda = 0;
        bool held = false;  ///< SCL is low since the last byte
    };
    std::size_t line(const std::string& scope, const std::string& from, const std::string& name,
                     Line::Kind kind);
    void event(cosim::Time time, std::size_t line, int change);
    void active(std::size_t line, cosim::Time begin, cosim::Time end);
    void uart(const cosim::TraceRow& row, const cosim::UartFrame& frame);
    void i2c(const I2cStep& step);
    Wires& wires_of(const std::string& bus);
    cosim::Time i2c_start(const Wires& wires, const I2cStep& step);
    void i2c_byte(Wires& wires, const I2cStep& step);
    void i2c_lost(const I2cStep& step, const FaultMark& mark);
    void mark(const FaultMark& mark);
    void signal(const cosim::TraceRow& row, const cosim::Signal& signal);

    static const FaultMarks kNoMarks;
    Emit emit_;
    const FaultMarks& marks_;
    FaultMarkCursor alone_{marks_};
    I2cTransfers transfers_;
    std::vector<Line> lines_;
    std::map<std::string, std::size_t, std::less<>> index_;
    std::map<std::string, Wires> buses_;
    std::vector<bool> level_;                         // of pins
    std::map<std::size_t, cosim::Time> low_since_{};  // UART lines that rest low
    cosim::Time now_ = 0, late_ = 0, last_ = 0, shortest_ = cosim::kNever;
};

}  // namespace puckloop::tools
