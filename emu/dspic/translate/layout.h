#pragma once
// Where translated code finds a machine's fields: distances from Machine::st, which one host register holds.

#include "emu/dspic/machine/machine.h"

namespace puckloop::dspic::translate {

struct Layout {
    explicit Layout(const Machine& m);

    int w, sr, corcon, cycle, rcount, disi_end, psvpag, repeat_first;
    int current, code, limit, watch, stack_span, ram, instructions, eligible, skip_idle;
    int disi_waits, line, plain, wait_level, stays, stale_after, loop_index, loop_waits, entries;
    std::uint32_t ram_words, code_words;
    int ifs, iec, ifs_words;  ///< of the device: data addresses
};

}  // namespace puckloop::dspic::translate
