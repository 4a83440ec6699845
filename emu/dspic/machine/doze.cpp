// Doze mode of the 33FJ: the CPU's clock is the peripherals' divided by CLKDIV<DOZE> while DOZEN is set.
// Source: DS70286, sections 9.3 and 8 (CLKDIV); fact sheet semantics.md section 17.
//
// A cycle of the chip is one of the peripherals' clock. A CPU cycle is `ratio` of them; what an instruction
// reads and writes, it reads and writes in the last one, so that a write counts from the next CPU cycle on,
// as without Doze. Deviations, where the sheet is silent:
//   1. The first slow CPU cycle begins behind the instruction that set DOZEN; one that clears it, or writes
//      another DOZE while DOZEN is set, takes the old ratio itself, and the next one the new.
//   2. With ROI an exception that the CPU accepts, a trap too, clears DOZEN at the end of the CPU cycle in
//      which it came: entry and routine are at full speed. One that its priority holds back clears nothing.
//   3. Waits are not skipped and nothing is translated meanwhile: Doze costs the host what it costs.

#include "emu/dspic/devices/dspic33fj256gp710_sfr.h"
#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/machine/machine.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kCLKDIV{"CLKDIV"};

void set(Machine& m, bool on, unsigned ratio) {
    // DISI counts CPU cycles.
    if (m.st.disi_end > m.st.cycle)
        m.st.disi_end = m.st.cycle + (m.st.disi_end - m.st.cycle) / m.doze.ratio * ratio;
    m.doze.on = on;
    m.doze.ratio = ratio;
}

}  // namespace

void doze_changed(Machine& m) {
    const std::uint16_t clkdiv = m.sfr.raw(sfr33::CLKDIV);
    const bool on = clkdiv & kCLKDIV["DOZEN"];
    m.doze.recovers = clkdiv & kCLKDIV["ROI"];
    if (!m.doze.on && on) {
        m.doze.entry = m.st.cycle;
        m.limit = 0;
    }
    set(m, on, on ? 1u << kCLKDIV["DOZE"].of(clkdiv) : 1u);
}

void recover(Machine& m) {
    if (!m.doze.on || !m.doze.recovers) return;
    m.sfr.raw(sfr33::CLKDIV) &= static_cast<std::uint16_t>(~kCLKDIV["DOZEN"]);
    m.since = std::max(m.since, m.st.cycle);
    set(m, false, 1);
}

void stretch(Machine& m, Cycle began) {
    const Cycle cycles = m.st.cycle - began;
    if (cycles == 0) return;
    m.st.cycle = began;
    if (m.eligible) recover(m);
    m.st.cycle += m.doze.ratio;
    m.doze.remaining_cycles = cycles - 1;
}

void consume_cycle(Machine& m) {
    if (m.eligible) recover(m);
    m.st.cycle += m.doze.ratio;
    --m.doze.remaining_cycles;
}

}  // namespace puckloop::dspic
