#pragma once
// What went over the line between program and PIC in a whole run, from its trace: where the bytes of a record
// were, and how the two sides ended up.

#include "tests/end_to_end/kit/workbench.h"

#include <string>
#include <vector>

namespace puckloop::framing {

inline constexpr std::size_t kHello = 5, kActuatorBytes = 12, kSensorBytes = 72;

/// One byte's start bit on its way.
struct Byte {
    bool to_pic = true;
    std::size_t place = 0;  ///< in its record
    double start = 0;
};

struct Outcome {
    bool linux_goes_on = false;  ///< it still sends records at the end
    bool pic_goes_on = false;
    bool shifted = false;  ///< to the end, one side takes parts of two records for one
    bool drives = false;   ///< the robot moves in the last second
    double gap = 0;        ///< s, the longest without a byte from the PIC
};

/// Which side forgets a part of a record after 20 ms of silence.
struct Forgets {
    bool pic = true, linux = true;
};

/// The UART's rows of the run's trace.
std::vector<tests::Row> uart_rows(const tests::Workbench& bench, const std::string& name);
/// Starts of the bytes of both records number `record`, counted from 0, in a run without a fault, the
/// actuator record's first.
std::vector<Byte> bytes_of(const std::vector<tests::Row>& rows, std::size_t record);
/// All but Outcome::drives, of what went over the line after `fault_s`.
Outcome judge(const std::vector<tests::Row>& rows, const Forgets& forgets, double fault_s, double end_s);

}  // namespace puckloop::framing
