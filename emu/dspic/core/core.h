#pragma once
// The dsPIC30F/33F CPU: instructions, their cycles, interrupts, traps and resets. Abstract over everything
// around it: registers of other modules through SfrSpace, time through EventQueue.
// Sources: programmer's reference (DS70157), family reference manual (DS70049..DS70055).
// Deviations are numbered in docs/fidelity.md under "dsPIC core".

#include "base/states/archive.h"
#include "base/states/checkpoint.h"
#include "emu/chip/instrument.h"
#include "emu/dspic/devices/device.h"
#include "emu/dspic/devices/errata.h"
#include "emu/dspic/machine/core_observer.h"
#include "emu/dspic/machine/core_state.h"
#include "emu/dspic/machine/event_queue.h"
#include "emu/dspic/machine/gate.h"
#include "emu/dspic/machine/interrupts.h"
#include "emu/dspic/machine/sfr_space.h"
#include "emu/dspic/machine/stays.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

namespace puckloop::dspic {

/// One word of program space. `address` in program-counter units, even; EEPROM and configuration words too.
struct ProgramWord {
    std::uint32_t address = 0;
    std::uint32_t word = 0;  ///< 24 bits
};

struct FastWork;
struct Machine;

class Core {
  public:
    Core(const DeviceInfo& device, SfrSpace& sfr, EventQueue& events, InterruptController& interrupts);
    ~Core();
    Core(const Core&) = delete;
    Core& operator=(const Core&) = delete;

    // Program space.
    /// Throws InputError naming the address if a word lies where the device has no memory.
    void load(std::span<const ProgramWord> words);
    /// Erases every memory, then writes these words; those where the device has no memory are left out.
    /// Allowed while a mark is set, and between two run() only.
    void reprogram(std::span<const ProgramWord> words);
    /// 24-bit word at an even address; unimplemented memory reads 0.
    std::uint32_t program(std::uint32_t address) const;
    /// False if the device has no memory there.
    bool poke_program(std::uint32_t address, std::uint32_t word);
    std::uint16_t config(std::uint32_t address) const;  ///< low 16 bits of a configuration word

    // Running.
    /// Resets the core; calls the reset hook first so that everything else resets too.
    void reset(ResetCause cause);
    enum class Outcome : std::uint8_t { Until, Stopped };
    /// Executes every instruction that starts before `until` and services every event due before it.
    /// `Stopped`: the PC is at a stop address, the instruction there has not been executed; the next run()
    /// executes it. cycle() may end a few cycles past `until`.
    Outcome run(Cycle until);
    /// From inside a hook or event handler: the run() in progress returns Until before its next instruction
    /// (the clock's rate changed, so that its `until` is another cycle now).
    void end_run();
    /// run() ends, as if its `until` were there, before an instruction that begins at `from` or later and may
    /// access one of the registers, and before a reset from then on. kNoCycle: it does not. Whose list stays.
    void hold_before(Cycle from, const RegisterSet* registers);
    bool held_back() const;  ///< the last run() ended so
    /// Exactly one instruction (or one interrupt entry, or one iteration of a repeated instruction); the
    /// chip's own events up to its start are serviced first.
    void step();
    /// Stop addresses (PC values); an empty list means none. They cost nothing elsewhere.
    void set_stops(std::span<const std::uint32_t> addresses);
    /// Busy-wait loops are skipped without changing anything observable. On from the start.
    void set_skip_idle(bool on);
    /// Hot code is translated to the host's, where that is possible, without changing anything observable: by
    /// default as emu/chip/translate/translation_switch.h states.
    void set_translate(bool on);
    /// Instructions do what these say; none from the start.
    void set_errata(const Errata& errata);
    /// From now on `instrument` looks on, at data accesses too if `accesses`; null: nobody does. Between runs
    /// only; set_skip_idle() and set_translate() are to be called without one.
    void set_instrument(chip::Instrument* instrument, bool accesses = false);
    /// Keeps the CPU from executing until `cycle` (flash programming, oscillator start-up); events go on.
    void stall_until(Cycle cycle);
    /// In reset until set otherwise: nothing is executed, the watchdog stands. Resets pass.
    void hold(bool on);
    /// A reset as soon as what is under way allows; from within events.
    void request_reset(ResetCause cause);

    // Seen from outside.
    Cycle cycle() const;  ///< where the next instruction starts; inside hooks: the present one's
    /// The counter behind cycle(), for models that look at it at every register access.
    const Cycle& cycle_counter() const;
    std::uint32_t pc() const;            ///< of the next instruction; inside hooks: of the present one
    std::uint64_t instructions() const;  ///< executed since power-up, iterations counted, skipped ones too
    const FastWork& fast_work() const;   ///< what was passed and not executed (fast/fast_work.h)
    PowerMode power_mode() const;
    int cpu_level() const;  ///< IPL3:IPL2:0, 0..15
    const DeviceInfo& device() const;
    /// The loop that the program is in, if it has been there for a while (waits/wait_watch.h).
    struct BusyLoop {
        Cycle since = 0;
        int level = 0;  ///< CPU priority
        LoopFinding finding;
    };
    std::optional<BusyLoop> busy_loop() const;
    /// Loops that waited for what no model drives, in the order of their times.
    std::span<const MissingPoll> missing_polls() const;

    /// A consistent copy; DISICNT is state().disi_end - cycle().
    CoreState state() const;
    /// Every W register counts as written; W15 is taken as given, odd or not.
    void set_state(const CoreState& state);
    std::uint16_t w(int index) const;
    void set_w(int index, std::uint16_t value);
    void set_pc(std::uint32_t pc);
    /// Data space as the CPU would read it, byte address even; SFR reads have their side effects.
    std::uint16_t read_data(std::uint16_t address);
    void write_data(std::uint16_t address, std::uint16_t value);
    /// RAM words from device().ram_start on.
    std::span<std::uint16_t> ram();

    /// Everything the core remembers, program space and RAM included, stop addresses not. Decoded operations
    /// and what is known of loops and service routines are found anew. SFRs are loaded before.
    void state(StateWriter& archive) const;
    void state(StateReader& archive);
    /// The same but for program space, decoded operations and what is known of loops and service routines:
    /// from mark() on their changes are noted, and rewind() takes them back, before the checkpoint is read;
    /// the mark stays. settle() gives it up. Stop addresses stay as they are between the three.
    void state(CheckpointWriter& archive) const;
    void state(CheckpointReader& archive);
    void mark();
    void rewind();
    void settle();

    // Hooks.
    /// Called at each reset before the core's own: sets every other SFR and module to its reset state.
    void set_reset_hook(std::function<void(ResetCause)> hook);
    /// Called when PWRSAV and wake-up change the mode.
    void set_power_hook(std::function<void(PowerMode)> hook);
    /// Called after each write of RCON and once a reset has set it.
    void set_rcon_hook(std::function<void()> hook);
    /// Instruction rate in hertz: the watchdog and flash timing need it. Call at each clock change.
    void set_cycle_rate(double hertz);
    /// 33FJ: CLKDIV has been written, or a reset has set it: the CPU's clock follows (Doze).
    void doze_changed();
    /// Cycles in a CPU cycle: 1 but in Doze.
    Cycle cpu_cycle() const;
    /// What the oscillator takes after Sleep, from now on.
    void set_wake_time(double seconds);
    CoreObserver& observer();

  private:
    std::unique_ptr<Machine> machine_;
};

}  // namespace puckloop::dspic
