#pragma once
// Everything a dsPIC core remembers, in one plain struct, with the data sheet's names: save, compare and
// print are free. Data RAM, program memory and the SFR words of other modules live beside it.

#include "emu/dspic/machine/event_queue.h"

#include <array>
#include <cstdint>

namespace puckloop::dspic {

/// Bits of SR.
namespace sr {
inline constexpr std::uint16_t C = 1u << 0, Z = 1u << 1, OV = 1u << 2, N = 1u << 3, RA = 1u << 4,
                               IPL = 7u << 5, DC = 1u << 8, DA = 1u << 9, SAB = 1u << 10, OAB = 1u << 11,
                               SB = 1u << 12, SA = 1u << 13, OB = 1u << 14, OA = 1u << 15;
inline constexpr int kIplShift = 5;
}  // namespace sr

/// Bits of CORCON.
namespace corcon {
inline constexpr std::uint16_t IF = 1u << 0, RND = 1u << 1, PSV = 1u << 2, IPL3 = 1u << 3, ACCSAT = 1u << 4,
                               SATDW = 1u << 5, SATB = 1u << 6, SATA = 1u << 7, DL = 7u << 8, EDT = 1u << 11,
                               US = 1u << 12;
inline constexpr int kDlShift = 8;
}  // namespace corcon

/// Bits of RCON.
namespace rcon {
inline constexpr std::uint16_t POR = 1u << 0, BOR = 1u << 1, IDLE = 1u << 2, SLEEP = 1u << 3, WDTO = 1u << 4,
                               SWDTEN = 1u << 5, SWR = 1u << 6, EXTR = 1u << 7, BGST = 1u << 13,
                               IOPUWR = 1u << 14, TRAPR = 1u << 15;
}  // namespace rcon

/// One level of hardware loop.
struct DoLoop {
    std::uint16_t dcount = 0;
    std::uint32_t dostart = 0;
    std::uint32_t doend = 0;

    template <class Archive>
    void state(Archive& archive) {
        archive(dcount, dostart, doend);
    }
};

/// More than any run has: twenty years at 30 MHz.
inline constexpr Cycle kLastCycle = Cycle{1} << 54;

struct CoreState {
    std::array<std::uint16_t, 16> w{};
    std::uint16_t sr = 0;
    std::uint16_t corcon = 0;
    std::array<std::int64_t, 2> acc{};  ///< A and B, 40 bits, kept sign extended
    std::uint16_t rcount = 0;
    DoLoop loop;
    DoLoop loop_shadow;
    std::array<std::uint16_t, 4> shadow_w{};  ///< PUSH.S
    std::uint16_t shadow_sr = 0;              ///< DC N OV Z C of it
    std::uint16_t tblpag = 0;
    std::uint16_t psvpag = 0;
    std::uint16_t splim = 0;
    bool splim_armed = false;  ///< written since reset
    std::uint16_t modcon = 0;
    std::uint16_t xmodsrt = 0, xmodend = 1;
    std::uint16_t ymodsrt = 0, ymodend = 1;
    std::uint16_t xbrev = 0;
    Cycle disi_end = 0;  ///< first cycle in which DISICNT is 0 again
    std::uint32_t pc = 0;
    Cycle cycle = 0;  ///< the next (or present) instruction starts here

    template <class Archive>
    void state(Archive& archive) {
        archive(w, sr, corcon, acc, rcount, loop, loop_shadow, shadow_w, shadow_sr, tblpag, psvpag, splim,
                splim_armed, modcon, xmodsrt, xmodend, ymodsrt, ymodend, xbrev, disi_end, pc);
        archive.bounded(cycle, 0, kLastCycle);
    }
};

}  // namespace puckloop::dspic
