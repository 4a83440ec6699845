#pragma once

#include "emu/dspic/machine/event_queue.h"

namespace puckloop::dspic {

/// What an output compare module does with its pin. No call per edge: see Pins::output_compare_changed().
struct OutputCompareState {
    int mode = 0;          ///< OCxCON<OCM>: 0 off, 3 toggle, 4 single pulse, 5 pulses, 6 and 7 PWM, ...
    bool running = false;  ///< its timer counts: edges come by themselves
    Cycle period = 0;      ///< between rising edges, instruction cycles; 0 while nothing repeats
    Cycle high = 0;        ///< of each period, 0..period
    bool level = false;    ///< of the pin where nothing repeats

    friend bool operator==(const OutputCompareState&, const OutputCompareState&) = default;

    template <class Archive>
    void state(Archive& archive) {
        archive(mode, running, period, high, level);
    }
};

}  // namespace puckloop::dspic
