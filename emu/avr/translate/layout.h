#pragma once
// Where translated code finds a core's fields, as distances from the Machine, and its tables.

#include "emu/avr/machine/machine.h"

#include <array>
#include <cstdint>

namespace puckloop::avr::translate {

struct Layout {
    explicit Layout(const Machine& m);

    int data, sreg, sp, cycle, limit, instructions, code, current, now, skip_idle, loops, entries;
    std::uint32_t ram_start, ram_bytes, flash_words;

    struct Tables {
        /// HSVNZC by the host's flags as LAHF has them, + 256 if it overflowed.
        std::array<std::uint8_t, 512> flags;
        /// The same where V is N ^ C, by LAHF alone.
        std::array<std::uint8_t, 256> shift_flags;
        /// 0 where the data addresses with this upper byte are RAM.
        std::array<std::uint8_t, 256> not_ram;
    } tables;
};

}  // namespace puckloop::avr::translate
