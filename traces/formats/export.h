#pragma once
// A recorded trace in the formats of other tools. Each reads the trace in passes and keeps little of it.

#include "traces/recorded_trace.h"

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Rows as they were, wanted ones only.
void export_csv(const RecordedTrace& trace, std::ostream& out);

/// Values of another source, such as registers, beside the lines of a value change dump.
class VcdValues {
  public:
    struct Variable {
        std::string scope, name;
        unsigned bits = 1;
    };
    struct Change {
        cosim::Time time = 0;
        std::size_t variable = 0;
        std::uint64_t value = 0;
    };
    virtual ~VcdValues() = default;
    virtual std::vector<Variable> variables() const = 0;
    /// In the order of time.
    virtual std::optional<Change> next() = 0;
};

/// Value change dump (IEEE 1364), for GTKWave and its like: the lines of traces/lines.h, and beside them
/// `byte` of a UART while a frame lasts, `phase` and `byte` of I2C, `octets` of a radio and the value of each
/// signal. `timescale`: "1 us", "100 ns", ..., "1 ps"; empty: the coarsest of them in which the shortest bit
/// has 16 units. Times are rounded down to it; of changes of one line within a unit the last one shows.
/// Throws InputError for another timescale.
void export_vcd(const RecordedTrace& trace, std::ostream& out, const std::string& timescale = {});
/// `values` go into the same dump, in picoseconds: instruction cycles are no whole nanoseconds.
void export_vcd_with(const RecordedTrace& trace, std::ostream& out, VcdValues& values);

/// pcapng for Wireshark, times in nanoseconds, one interface for each sender on each link (I2C: for each
/// bus).
///   UART   LINKTYPE_RTAC_SERIAL: bytes sent without a pause in one packet; a break, a wrong parity bit and a
///          frame with a fault in a packet of their own
///   I2C    LINKTYPE_I2C_LINUX: what lies between a START and the next START or STOP in one packet
///   radio  LINKTYPE_IEEE802_15_4_WITHFCS, what was on the air
///   faults that leave no mark in the trace (traces/fault_marks.h), unless it is a byte's on a bus: one
///   packet of
///          text each, LINKTYPE_WIRESHARK_UPPER_PDU
/// Packets are in the order of their times. One that became known more than 100 ms (of an open transfer: 10
/// s) after its begin has the time of the packet before it, and its own in the comment. What a fault did, a
/// missing acknowledge and a lost bus are in the packet's comment. Signals have no place.
void export_pcapng(const RecordedTrace& trace, std::ostream& out);

/// sigrok session (srzip) with the lines of traces/lines.h as logic channels. `rate` in samples per second,
/// at most 1e9; 0: at least 16 samples in the shortest bit. The first sample is at `--from`, or at 0. Throws
/// InputError when there is no line or too many samples, RunError when the file cannot be written.
void export_sr(const RecordedTrace& trace, const std::string& path, std::uint64_t rate);

}  // namespace puckloop::tools
