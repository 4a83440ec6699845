#pragma once
// The AVR CPU: instructions, their cycles, interrupts, sleep and resets. Abstract over everything around it:
// registers of other modules through IoSpace, time through EventQueue.
// Sources: AVR Instruction Set Manual (DS40002198), ATmega1284P data sheet (8272), chapters "AVR CPU Core"
// and "AVR Memories". Deviations are numbered in docs/fidelity.md under "AVR core".

#include "emu/avr/devices/device.h"
#include "emu/avr/machine/core_observer.h"
#include "emu/avr/machine/interrupts.h"
#include "emu/avr/machine/state.h"
#include "emu/chip/instrument.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace puckloop {
class CheckpointReader;
class CheckpointWriter;
class StateReader;
class StateWriter;
}  // namespace puckloop

namespace puckloop::avr {

/// A loop that waits for something that only others can change.
struct WaitingLoop {
    std::uint16_t head = 0, branch = 0;  ///< program words
    std::uint16_t polled = 0;            ///< data address of a register that it reads; 0: none
    bool reads_ram = false;
    Cycle since = 0;
};

struct Machine;

class Core {
  public:
    Core(const DeviceInfo& device, IoSpace& io, EventQueue& events, InterruptController& interrupts);
    ~Core();
    Core(const Core&) = delete;
    Core& operator=(const Core&) = delete;

    // Program memory, by word address.
    std::uint16_t program(std::uint32_t address) const;
    /// What was decoded from the old word is forgotten. Addresses past the flash are ignored.
    void set_program(std::uint32_t address, std::uint16_t word);

    // Running.
    /// Resets the core; calls the reset hook first.
    void reset(ResetCause cause);
    /// The same before the next instruction: what a peripheral calls.
    void request_reset(ResetCause cause);
    enum class Outcome : std::uint8_t { Until, Stopped };
    /// Executes every instruction that starts before `until` and services every event due before it.
    /// `Stopped`: the PC is at a stop address, the instruction there has not been executed; the next run()
    /// executes it. cycle() may end a few cycles past `until`.
    Outcome run(Cycle until);
    /// From inside a hook or event handler: the run() in progress returns before its next instruction.
    void end_run();
    /// Exactly one instruction or one interrupt entry; events due up to its start are serviced first.
    void step();
    /// Stop addresses (words); an empty list means none. They cost nothing elsewhere.
    void set_stops(std::span<const std::uint16_t> addresses);
    /// Busy-wait loops are skipped without changing anything observable. On from the start.
    void set_skip_idle(bool on);
    /// Hot code is translated to the host's, where that is possible, without changing anything observable: by
    /// default as emu/chip/translate/translation_switch.h states.
    void set_translate(bool on);
    /// From now on `instrument` looks on, at data accesses too if `accesses`; null: nobody does. Between runs
    /// only; set_skip_idle() and set_translate() are to be called without one.
    void set_instrument(chip::Instrument* instrument, bool accesses = false);
    /// Keeps the CPU from executing until `cycle`; events go on.
    void stall_until(Cycle cycle);
    /// The CPU executes nothing until one of the vectors in `wakers` (bit n = vector n) requests and
    /// interrupts are enabled, and `start_up` clocks more. Then CoreHooks::wake is called.
    void sleep(std::uint64_t wakers, std::uint32_t start_up);
    bool sleeping() const;
    /// Asleep, with no interrupt or reset that would end it: only an event can.
    bool rests() const;

    // Seen from outside.
    Cycle cycle() const;  ///< where the next instruction starts
    /// When the register access in progress happens, or the event in progress is due: what peripherals call
    /// now.
    const Cycle& now() const;
    /// What is handed in from outside a run happens at this cycle.
    void set_now(Cycle now);
    std::uint16_t pc() const;            ///< of the next instruction; inside hooks: of the present one
    std::uint64_t instructions() const;  ///< executed since power-up
    Cycle skipped() const;               ///< cycles in idle loops that were not executed one by one
    const DeviceInfo& device() const;

    /// The loop in which the program has waited up to now, if it is in one that changes nothing (seen only
    /// while idle loops are skipped). Interrupt routines may have run meanwhile.
    std::optional<WaitingLoop> waiting() const;
    CoreState state() const;
    void set_state(const CoreState& state);
    /// The whole data space as the CPU would read and write it: registers have their side effects.
    std::uint8_t read_data(std::uint16_t address);
    void write_data(std::uint16_t address, std::uint8_t value);
    /// RAM from device().ram_start on.
    std::span<std::uint8_t> ram();

    /// Everything but stop addresses, hooks and observers.
    void state(StateWriter& archive) const;
    void state(StateReader& archive);
    /// The same but for program memory: from mark() on its changes are noted, and rewind() takes them back,
    /// before the checkpoint is read; the mark stays. settle() gives it up.
    void state(CheckpointWriter& archive) const;
    void state(CheckpointReader& archive);
    void mark();
    void rewind();
    void settle();

    CoreObserver& observer();
    CoreHooks& hooks();

  private:
    std::unique_ptr<Machine> machine_;
};

}  // namespace puckloop::avr
