#pragma once
// The interrupt controller: IFS, IEC, IPC, INTCON1/2 and the trap flags. It decides which source is first in
// line; the core decides when to take it (emu/dspic/core/core.h). Source: dsPIC30F family reference manual,
// "Interrupts" (DS70053), and the vector tables of the parts. Deviations:
//   1. soft traps are sampled like hard ones, at the next instruction boundary.

#include "emu/dspic/devices/device.h"
#include "emu/dspic/machine/event_queue.h"
#include "emu/dspic/machine/sfr_space.h"

#include <array>
#include <cstdint>
#include <optional>

namespace puckloop::dspic {

/// Trap sources. The number is the vector; trap_flag() gives the bit of INTCON1.
enum class Trap : std::uint8_t {
    OscillatorFail = 1,
    AddressError = 2,
    StackError = 3,
    MathError = 4,
    DmacError = 5
};

/// CPU priority of a trap: 14 oscillator, 13 address, 12 stack, 11 math, 10 DMA controller.
constexpr int trap_level(Trap trap) {
    return 15 - static_cast<int>(trap);
}
/// The bit of INTCON1 that flags it. Stack and address error stand there the other way round than in the
/// vector table: OSCFAIL 1, STKERR 2, ADDRERR 3, MATHERR 4, DMACERR 5.
constexpr std::uint16_t trap_flag(Trap trap) {
    const int bit = trap == Trap::AddressError ? 3 : trap == Trap::StackError ? 2 : static_cast<int>(trap);
    return static_cast<std::uint16_t>(1u << bit);
}

class InterruptController {
  public:
    InterruptController(const DeviceInfo& device, SfrSpace& sfr);

    // For peripherals. `now` is the cycle in which the flag is set: the event's due cycle, or the core's
    // cycle when a register access causes it. Entry latency counts from there.
    void raise(int irq, Cycle now);
    /// The source asks for service without an interrupt of its own: what a DMA channel may serve, too.
    void request(int irq, Cycle now) {
        if (tapped(irq)) [[unlikely]]
            tap_(tap_owner_, irq, now);
    }
    bool tapped(int irq) const { return tapped_[static_cast<std::size_t>(irq) / 64] >> (irq % 64) & 1; }
    /// Calls `served` at every raise() and request() of the sources in `irqs` (bit n % 64 of word n / 64).
    void set_tap(void* owner, void (*served)(void* owner, int irq, Cycle now),
                 const std::array<std::uint64_t, 2>& irqs);

    /// Asks `passes` at every event of the sources in `irqs` that would set the flag; false: it stays clear.
    void set_gate(void* owner, bool (*passes)(void* owner, int irq, Cycle now),
                  const std::array<std::uint64_t, 2>& irqs);
    bool gated(int irq) const { return gated_[static_cast<std::size_t>(irq) / 64] >> (irq % 64) & 1; }
    /// raise() past gate and tap.
    void set_flag(int irq, Cycle now);

    /// Until somebody clears its flag, enables it or taps it, raise() of this source changes nothing.
    bool is_deaf(int irq) const { return !enabled(irq) && rests_ && flag(irq) && !tapped(irq); }
    /// The source stops raising while is_deaf(). `wake` is called once, with the cycle up to which raising
    /// would have changed nothing, when that is over, or with no need at any other time.
    void rest(int irq, void* owner, void (*wake)(void* owner, Cycle passed));
    /// No source rests any more, and none is woken: what is loaded is another state.
    void forget_rests() { line_.resting = {}; }
    /// Off: every source raises as it is due (on from the start).
    void set_resting(bool on);
    void clear(int irq);
    bool flag(int irq) const { return ifs()[irq / 16] >> (irq % 16) & 1; }
    bool enabled(int irq) const { return iec()[irq / 16] >> (irq % 16) & 1; }
    /// The IPC field of the source, 0..7.
    int priority(int irq) const { return (&sfr_.raw(device_.ipc))[irq / 4] >> (4 * (irq % 4)) & 7; }
    /// Sets the trap's flag in INTCON1.
    void raise_trap(Trap trap, Cycle now);
    /// Edge polarity of INTn, n = 0..4: true if INTCON2<INTnEP> selects the falling edge.
    bool falling_edge(int external) const;

    // For the core.
    struct Request {
        int level = 0;  ///< CPU priority it would run at: 1..7 user, 10..14 traps; 0 = nothing pending
        int vector = 0;
    };
    /// The first in line of everything flagged and enabled, whatever the CPU's priority is.
    const Request& first() const { return line_.first; }
    /// Who waits, and who rests, for translated code: it may take first() away, as serve_alone() does.
    struct Line {
        Request first;
        std::array<std::uint16_t, 8> resting{};  ///< sources that rest, by IFS word
    };
    Line& line() { return line_; }
    /// first() is a user interrupt, and no other source is flagged and enabled.
    bool waits_alone() const;
    /// Clears the flag of first(), which waits alone; the listener need not be called.
    void serve_alone();
    bool nesting_disabled() const;
    bool alternate_table() const;
    /// True when some source is flagged and enabled, priority 0 included: what ends Sleep and Idle.
    bool any_enabled_flag() const;
    /// Called after every change of first(), with the cycle of the change.
    void set_listener(void* owner, void (*changed)(void* owner, Cycle now));
    /// INTCON1's trap flags and enables, for the core's math rules.
    std::uint16_t intcon1() const { return sfr_.raw(kIntcon1); }
    /// Latches vector and level into INTTREG where the part has it.
    void acknowledge(const Request& taken, int cpu_level_before);
    /// The core's present cycle, which stamps software's writes, and the cycle at which DISICNT reaches 0,
    /// which INTCON2<DISI> shows.
    void set_clock(const Cycle* now, const Cycle* disi_end) {
        now_ = now;
        disi_end_ = disi_end;
    }
    void reset();

    /// After the registers were loaded: who is first in line, without calling the listener.
    void registers_loaded();

    static constexpr std::uint16_t kIntcon1 = 0x080;
    static constexpr std::uint16_t kIntcon2 = 0x082;

  private:
    struct Rester {
        void* owner = nullptr;
        void (*wake)(void* owner, Cycle passed) = nullptr;
    };
    void list_writable();
    const std::uint16_t* ifs() const { return &sfr_.raw(device_.ifs); }
    const std::uint16_t* iec() const { return &sfr_.raw(device_.iec); }
    void find_first(Cycle now);
    void wake(int irq);
    void wake_hearing(int word);  ///< resting sources of this IFS word that are not deaf any more
    static std::uint16_t read_register(void* owner, std::uint16_t address);
    static void write_register(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);

    const DeviceInfo& device_;
    SfrSpace& sfr_;
    std::array<std::uint16_t, 8> implemented_{};  ///< IFS/IEC bits that exist
    std::array<std::uint16_t, 64> writable_{};    ///< bits that a write changes, by word from INTCON1 on
    std::array<std::uint64_t, 2> tapped_{};
    void* tap_owner_ = nullptr;
    void (*tap_)(void*, int, Cycle) = nullptr;
    std::array<std::uint64_t, 2> gated_{};
    void* gate_owner_ = nullptr;
    bool (*gate_)(void*, int, Cycle) = nullptr;
    bool rests_ = true;
    std::array<Rester, 128> resters_{};
    Line line_;
    void* listener_ = nullptr;
    void (*changed_)(void*, Cycle) = nullptr;
    const Cycle* now_ = nullptr;
    const Cycle* disi_end_ = nullptr;
};

}  // namespace puckloop::dspic
