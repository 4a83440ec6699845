#pragma once
// A whole microcontroller: core, memories, clock, interrupt controller and peripherals, wired as in
// silicon. It knows no board: the board implements Pins, and gives the chip what arrives from outside.

#include "base/states/archive.h"
#include "base/states/checkpoint.h"
#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "cosim/core/time.h"
#include "cosim/core/work_counts.h"
#include "emu/chip/held_interrupts.h"
#include "emu/dspic/devices/device.h"
#include "emu/dspic/devices/errata.h"
#include "emu/dspic/judge/wait_report.h"
#include "emu/dspic/machine/event_queue.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/serial/uart_counters.h"
#include "emu/dspic/peripherals/timing/output_compare_state.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::image {
class CodePlaces;
struct Image;
}  // namespace puckloop::image

namespace puckloop::dspic {

class Core;
class InterruptController;
class SfrSpace;

struct ChipOptions {
    double crystal_hertz = 7'372'800.0;  ///< what the board solders to OSC1/OSC2
    double ppm = 0.0;                    ///< the crystal's error, + is fast
    /// 30F: configuration word FOSC that is in force whatever the image states (a bootloader's words stay on
    /// the part).
    std::optional<std::uint16_t> fosc{};
    Errata errata{};  ///< of the 30F; the 33FJ has none of them
};

/// One entry each; times are the chip's cycles.
struct ResetRecord {
    Cycle cycle = 0;
    std::string cause;     ///< "POR", "EXTR", "SWR", "WDTO", "IOPUWR", "TRAPR"
    std::uint32_t pc = 0;  ///< address of the instruction that was about to run or that caused it

    template <class Archive>
    void state(Archive& archive) {
        archive(cycle, cause, pc);
    }
};
struct TrapRecord {
    Cycle cycle = 0;
    std::string name;  ///< "AddressError", "StackError", "MathError", "OscillatorFail"
    std::uint32_t pc = 0;

    template <class Archive>
    void state(Archive& archive) {
        archive(cycle, name, pc);
    }
};
struct UnmodelledTouch {
    Cycle cycle = 0;
    std::string name;  ///< empty where the device has no register
    std::uint16_t address = 0;
    std::uint32_t pc = 0;
    bool write = false;

    template <class Archive>
    void state(Archive& archive) {
        archive(cycle, name, address, pc, write);
    }
};
/// Something the program did that the model takes differently from silicon, reported once each.
struct ChipWarning {
    Cycle cycle = 0;
    std::string text;
    std::uint32_t pc = 0;

    template <class Archive>
    void state(Archive& archive) {
        archive(cycle, text, pc);
    }
};

/// An I2C address to which the chip spoke as master, and nobody answered.
struct RefusedAddress {
    int unit = 1;
    std::uint8_t address = 0;  ///< 7 bits
    std::uint64_t times = 0;
};

struct ChipReport {
    std::vector<ResetRecord> resets;          ///< the first 1000, power-on included
    std::vector<TrapRecord> traps;            ///< the first 1000
    std::vector<UnmodelledTouch> unmodelled;  ///< first touch of each register
    std::vector<ChipWarning> warnings;
    std::vector<MissingBitReport> missing_bits;     ///< at most 100
    std::vector<RefusedAddress> refused_addresses;  ///< by unit and address
    std::uint64_t instructions = 0;
    Cycle cycles = 0;

    template <class Archive>
    void state(Archive& archive) {
        archive.grows(resets, traps, unmodelled, warnings);
    }
};

/// Use: construct, load, power_on(), then run_until() in rising steps, handing in what arrives in between.
class Chip {
  public:
    Chip(const DeviceInfo& device, Pins& pins, const ChipOptions& options = {});
    ~Chip();
    Chip(const Chip&) = delete;
    Chip& operator=(const Chip&) = delete;

    /// Program, configuration and EEPROM words of an image; throws InputError if they do not fit the
    /// device.
    void load(const image::Image& image);
    /// One program, configuration or EEPROM word at a program address (even).
    void load_word(std::uint32_t address, std::uint32_t word);

    /// What a programmer at the board's connector does: all memories are erased and get the image's words, as
    /// if the chip had been loaded with them first. RAM and registers stay; a reset is the caller's. Between
    /// two run_until(). The image was checked against the device.
    void program(const image::Image& image);
    /// places() are this image's from now on.
    void name_places(const image::Image& image);

    /// What would be left without supply, by program address: flash and EEPROM words that are not erased, and
    /// every configuration word. load_word() of all of them into a new chip makes the same memory.
    std::map<std::uint32_t, std::uint32_t> memory() const;

    /// Power-up at time 0: all registers at power-on values, RCON.POR and BOR set. Once, before
    /// run_until().
    void power_on();
    /// A pulse on MCLR now.
    void mclr();

    /// Runs everything that starts strictly before `until`. Returns early at a stop address and where
    /// pause_at() requires it. An
    /// instruction that starts at time s has seen everything handed in after run_until(t), t <= s.
    void run_until(cosim::Time until);
    /// From within a call of Pins: run_until() ends at `time`, or at the end of the present instruction where
    /// that is later, so that what is due then can be handed in. Only the last call counts; kNever: none.
    void pause_at(cosim::Time time);
    /// Ends run_until() before the instruction at program address `pc` runs.
    void stop_at(std::uint32_t pc);
    /// The stop address at which run_until() returned early, until it is called again.
    std::optional<std::uint32_t> stopped_at() const;

    /// A character whose stop bit begins now arrives at UART `unit` (1 or 2).
    void uart_receive(int unit, const cosim::UartFrame& frame);
    /// The bus's answer (Acknowledge, Data or BusLost) to the last phase of I2C module `unit`, now.
    void i2c_answer(int unit, const cosim::I2cPhase& phase);
    /// From within Pins::i2c_phase(): the answer to this phase, which is already known, comes at `time`.
    void i2c_answer_at(int unit, const cosim::I2cPhase& phase, cosim::Time time);
    /// A phase that a bus master begins now reaches module `unit` as slave: Start, Write, Read or Stop.
    /// Each but Stop is answered through Pins::i2c_slave_answer(), with ack = 0 where the slave does not feel
    /// addressed.
    void i2c_slave_phase(int unit, const cosim::I2cPhase& phase);
    /// What the bus of module CAN`unit` has to say now (Pins::can_wired()).
    void can_news(int unit, const cosim::CanMessage& message);
    /// The crystal at OSC1 and OSC2 stops now, for good: the fail-safe clock monitor takes over, or the chip
    /// stands still.
    void stop_crystal();
    /// Levels that Pins::levels() reports for this port changed now: edges for INTx, CN, timer clocks and
    /// gates.
    void pins_changed(PortLetter port);
    /// Edges at one of the port's pins make a difference by themselves; else only reads of it do.
    bool monitors(PortLetter port) const;
    /// Pins::supply() is another one now.
    void supply_changed();

    /// Pins::next_edge() gives something else for edges from cycle `at` on. Allowed within calls of Pins.
    void edges_moved(Cycle at);

    /// Lookahead for the conductor: no uart_sent() call for `unit` carries a stop bit that begins before
    /// this. `nominal_bit` is the link's nominal bit period; faster senders must be stamped as on that
    /// link.
    cosim::Time earliest_uart_send(int unit, cosim::Time nominal_bit) const;
    /// Start of the frame that UART `unit` is shifting out and has not yet handed to Pins::uart_sent().
    std::optional<cosim::Time> uart_begun(int unit) const;
    UartCounters uart_counters(int unit) const;
    /// UARTEN of `unit`: its receiver listens.
    bool uart_enabled(int unit) const;
    /// No i2c_phase() call of module `unit` begins before this, unless an answer comes in; kNever while one
    /// is awaited.
    cosim::Time earliest_i2c(int unit) const;

    /// No i2c_slave_answer() call of module `unit` comes before this; kNever while no phase is open.
    cosim::Time earliest_i2c_slave_answer(int unit) const;
    /// Module OC`unit`; all zero if the device has none.
    OutputCompareState output_compare(int unit) const;

    const cosim::ClockDomain& clock() const;
    /// How far the chip has been run: the last `until`, or the start of the instruction at a stop address.
    /// What is handed in belongs to this time.
    cosim::Time now() const;
    Cycle cycle() const;
    std::uint32_t pc() const;
    /// Symbols and source lines by program address, of the image loaded last.
    const image::CodePlaces& places() const;
    /// A register's present value by data-sheet name, as the program would read it but without side
    /// effects. Throws std::out_of_range if the device has no such register.
    std::uint16_t peek(std::string_view register_name) const;
    /// A word of RAM at an even data address. Throws std::out_of_range elsewhere.
    std::uint16_t peek_data(std::uint16_t address) const;
    ChipReport report() const;
    /// What the core executed and passed, loops and routines analysed (fast/fast_work.h).
    void add_work(cosim::WorkCounts& counts) const;
    std::size_t resets() const;  ///< how many the report has, without making one
    /// What the program has been waiting for, if it has gone round in one loop, or slept, for a tenth of a
    /// second or more. Costs some milliseconds.
    std::optional<WaitReport> waiting() const;

    /// Everything the chip remembers, between two run_until(): registers, memories (flash and EEPROM too),
    /// modules, events, report. Stop addresses are the bench's and are left out. A chip of the same device
    /// that loads it goes on as this one does; StateError: it does not fit, and the chip is of no use.
    void state(StateWriter& archive) const;
    void state(StateReader& archive);
    /// The same for a checkpoint, taken after mark(): program memory and what is known of code stay out of
    /// it, their changes since the mark are taken back by rewind(), before the checkpoint is read. The mark
    /// stays until settle(). No stop address may be met or set between.
    void state(CheckpointWriter& archive) const;
    void state(CheckpointReader& archive);
    void mark();
    void rewind();
    void settle();

    /// Busy-wait loops are skipped forward (default); off, every cycle of them is executed.
    void set_skipping(bool on);

    /// What faults reach into (chip_faults.h), between two run_until().
    struct Inside {
        const DeviceInfo& device;
        Core& core;
        SfrSpace& sfr;
        InterruptController& interrupts;
        cosim::ClockDomain& clock;
        chip::HeldInterrupts& held;
    };
    Inside inside();
    /// Replaces the stop addresses. Unlike stop_at(), allowed while a mark is set.
    void set_stops(const std::vector<std::uint32_t>& addresses);

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace puckloop::dspic
