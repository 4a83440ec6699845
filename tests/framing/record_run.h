#pragma once
// One session of the control program's own code with real firmware on an emulated board, with one fault on
// one byte of the serial line, and what the wheels did meanwhile.

#include "linuxboard/control/control_loop.h"
#include "tests/exec/rig.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::framing {

enum class ByteFault : std::uint8_t { Lost, Doubled, Flipped };

struct RecordFault {
    bool to_pic = true;      ///< false: from the PIC to the Linux board
    unsigned long byte = 0;  ///< ordinal number on its way, from the session's first byte
    ByteFault kind = ByteFault::Lost;
    int bit = 0;  ///< Flipped: which

    std::string text() const;
};

/// Everything in seconds.
struct RecordRun {
    bool reached = false;  ///< the program ran to its end
    bool fired = false;
    double recovery = 0;  ///< from the fault to the next good sensor record
    double garbage = 0;   ///< longest time a wheel turned at a speed that none of the last two commands had
    double stale = 0;     ///< longest time a wheel turned beyond its command's own period and a margin
    int seen_wrong = 0;   ///< steps in which the behaviour saw a proximity or light value that no sensor had
    bool came_to_rest = false;  ///< wheels at rest half a second after the end
    bool next_session = false;  ///< the program, started again, gets its first record at once
    control::SessionCounters counters;
};

/// A board with an image, booted; sessions follow each other on it.
class RecordBench {
  public:
    RecordBench(const std::string& image, double ready);
    /// `steps` of drawn speeds with one fault, with so many exchanges of records in each.
    RecordRun run(const RecordFault& fault, std::uint64_t seed, int steps = 12, int exchanges = 1);
    double now_s() const { return rig_.now_s(); }

  private:
    exec::Rig rig_;
};

}  // namespace puckloop::framing
