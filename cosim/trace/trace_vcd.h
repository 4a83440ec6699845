#pragma once
// A recorded trace as a value change dump (IEEE 1364), for GTKWave and its like.
//
// One scope a link, one a sender. UART: `line`, bit for bit as on the wire, and `byte`, defined while a frame
// lasts. I2C: `phase` (a string, as GTKWave reads it) and `byte`. Signals: one real each. Deviation: SCL and
// SDA are not drawn bit by bit.

#include "cosim/trace/trace_row.h"

#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace puckloop::cosim {

class VcdWriter {
  public:
    /// Rows in the order of the trace. Frames that a fault kept from arriving are left out.
    void add(const TraceRow& row);
    /// Writes everything.
    void write(std::ostream& out);

  private:
    struct Variable {
        std::string link, from, name, type;
        unsigned width = 1;
        std::string initial;
    };
    struct Change {
        Time time = 0;
        std::size_t variable = 0;
        std::string value;  ///< with its type letter, without the identifier
    };

    std::size_t variable(const TraceRow& row, const std::string& name, const std::string& type,
                         unsigned width, const std::string& initial);
    void change(Time time, std::size_t variable, std::string value);
    void add_frame(const TraceRow& row, const UartFrame& frame);
    void write_declarations(std::ostream& out) const;

    std::vector<Variable> variables_;
    std::map<std::string, std::size_t> index_;
    std::vector<Change> changes_;
};

}  // namespace puckloop::cosim
