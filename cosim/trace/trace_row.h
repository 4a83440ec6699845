#pragma once
// One line of a recorded trace: what trace.csv holds and `puckloop trace` reads.
//
// Columns: time_s,link,from,kind,value,detail,start_s,period_s,stretch_s,fault
//   kind   value                 detail                                         start_s, period_s
//   uart   data, hex             8N1, 9E2, ...; " p0"/" p1": parity bit on the wire   start bit, bit time
//   break  -                     as uart                                        the same
//   i2c    byte, hex             start, write, read+ack, read+nack, stop, ack, nack, data, lost
//                                                                               begin of the phase, SCL
//                                                                               period
//   signal value in its unit     the signal's name, or #id                      -
//   radio  PHY payload, hex      channel and power, "ch12 -60dBm"               begin of the preamble, time
//   on
//                                                                               air
// Times have all their 12 digits: nothing is lost in a file but the acknowledge of phases that have none.

#include "cosim/core/message.h"
#include "cosim/core/time.h"
#include "cosim/faults/spec/fault_kind.h"

#include <string>
#include <string_view>

namespace puckloop::cosim {

struct TraceRow {
    Time time = 0;
    std::string link;
    std::string from;    ///< node that sent
    std::string signal;  ///< name, for signals
    FaultKind fault = FaultKind::None;
    Payload payload;

    friend bool operator==(const TraceRow&, const TraceRow&) = default;
};

inline constexpr std::string_view kTraceColumns =
    "time_s,link,from,kind,value,detail,start_s,period_s,stretch_s,fault";

/// Without the line end.
std::string to_csv(const TraceRow& row);

// The same for whoever writes many rows and keeps what is the same in them.
/// The columns of a link's sender, commas around them.
std::string sender_columns(std::string_view link, std::string_view from);
/// `name`, or "#id" where that is empty.
std::string signal_column(std::string_view name, std::uint16_t id);
/// Appends the row, without a line end; `signal` is looked at for signals only.
void append_row(std::string& out, Time time, std::string_view sender, const Payload& payload,
                std::string_view signal, FaultKind fault);
/// Throws InputError naming `file` and `line` for anything to_csv() does not write.
TraceRow parse_trace_row(std::string_view text, std::string_view file, std::size_t line);

/// Two lower-case hex digits an octet.
std::string hex_of(const Octets& octets);

/// "0.000123456789": seconds with all digits of a picosecond.
std::string format_seconds(Time time);

}  // namespace puckloop::cosim
