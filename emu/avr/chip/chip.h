#pragma once
// The ATmega1284P as a board sees it: core, registers, timetable and peripherals, wired up.

#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "cosim/core/time.h"
#include "emu/avr/core/core.h"
#include "emu/avr/devices/fuses.h"
#include "emu/avr/peripherals/pins.h"
#include "emu/chip/held_interrupts.h"
#include "emu/chip/uart_counters.h"
#include "emu/image/avr_image.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop {
class CheckpointReader;
class CheckpointWriter;
class StateReader;
class StateWriter;
}  // namespace puckloop

namespace puckloop::image {
class CodePlaces;
}

namespace puckloop::avr {

class Eeprom;

struct ChipOptions {
    double oscillator_hertz = 16e6;  ///< of the crystal or resonator
    double ppm = 0.0;                ///< its error, + is fast
    /// In force where the image brings none: full-swing crystal, no division, no JTAG, reset at 0.
    Fuses fuses{0xFF, 0xD9, 0xFD, 0xFF};
    double avcc = 5.0, aref = 5.0;  ///< volts
    /// Of the watch crystal at TOSC1 and TOSC2 (PC6, PC7); 0: none is fitted.
    std::uint32_t watch_hertz = 0;
};

struct ResetRecord {
    ResetCause cause{};
    std::uint32_t pc = 0;  ///< byte address
    Cycle cycle = 0;

    template <class Archive>
    void state(Archive& archive) {
        archive.bounded(cause, ResetCause::PowerOn, ResetCause::Watchdog);
        archive(pc, cycle);
    }
};
struct UnmodelledTouch {
    std::string name;  ///< data-sheet name; empty for an address without a register
    std::uint16_t address = 0;
    bool write = false;
    std::uint32_t pc = 0;

    template <class Archive>
    void state(Archive& archive) {
        archive(name, address, write, pc);
    }
};
struct ChipWarning {
    std::string text;
    std::uint32_t pc = 0;

    template <class Archive>
    void state(Archive& archive) {
        archive(text, pc);
    }
};
struct ChipReport {
    std::vector<ResetRecord> resets;          ///< the first 1000, power-on included
    std::vector<UnmodelledTouch> unmodelled;  ///< first touch of each register
    std::vector<ChipWarning> warnings;
    std::vector<std::uint8_t> refused_addresses;  ///< on the two-wire bus, that nobody acknowledged
    std::uint64_t instructions = 0;
    Cycle cycles = 0;
    Cycle skipped = 0;  ///< cycles in idle loops that this process did not execute one by one
};

/// One line about refused_addresses; nullopt if there are none.
std::optional<std::string> refused_text(const ChipReport& report);

/// Use: construct, load, power_on(), then run_until() in rising steps, handing in what arrives in between.
class Chip {
  public:
    Chip(const DeviceInfo& device, Pins& pins, const ChipOptions& options = {});
    ~Chip();
    Chip(const Chip&) = delete;
    Chip& operator=(const Chip&) = delete;

    /// Flash, EEPROM, fuses and lock bits of an image. The image was checked against the device.
    void load(const image::AvrImage& image);
    /// What a programmer at the board's connector does: flash and lock bits are erased, the EEPROM unless
    /// fuse EESAVE is programmed, and get what the image has; fuses stay. So does the boot section, where
    /// reset leads to it and the image has nothing for it. RAM and registers stay; a reset is the caller's.
    /// Between two run_until(). The image was checked against the device.
    void program(const image::AvrImage& image);
    /// places() are this image's from now on.
    void name_places(const image::AvrImage& image);
    /// What its memories hold now, as an image that load() takes.
    image::AvrImage memory() const;
    std::vector<std::uint8_t>& eeprom();
    const Fuses& fuses() const;
    /// For the next power_on(): what a programmer would set.
    void set_fuses(const Fuses& fuses);

    void power_on();
    /// A pulse on the reset pin now.
    void external_reset();
    /// The same, carried out before this returns; before an instruction, too (chip::Instrument).
    void reset_now();
    /// The supply (VCC and AVCC) from now on. Below the brown-out level of the fuses, or 1.3 V without one,
    /// the chip is held in reset until the supply is back (50 mV higher) and the start-up time of its fuses
    /// over. A chip begins with its options' avcc.
    void set_supply(double volts);
    double supply() const;

    /// Runs everything that starts strictly before `until`. Returns early only at a stop address.
    void run_until(cosim::Time until);
    /// Ends run_until() before the instruction at byte address `pc` runs.
    void stop_at(std::uint32_t pc);
    /// The stop address at which run_until() returned early, until it is called again.
    std::optional<std::uint32_t> stopped_at() const;

    /// A character whose stop bit begins now arrives at USART `unit` (0 or 1).
    void uart_receive(int unit, const cosim::UartFrame& frame);
    /// The bus's answer (Acknowledge, Data or BusLost) to the last phase of the two-wire interface; its ninth
    /// clock ends now.
    void twi_answer(const cosim::I2cPhase& phase);
    /// The same for a bus that knows its answer at once, from inside Pins::twi_phase(): the ninth clock ends
    /// at `time`.
    void twi_answer_at(const cosim::I2cPhase& phase, cosim::Time time);
    /// A phase that a bus master begins now; see Pins::twi_slave_answer().
    void twi_slave_phase(const cosim::I2cPhase& phase);
    /// Levels that Pins::levels() reports for this port, or analog inputs of the comparator, changed now.
    /// SPI slaves, and USARTs that are clocked from outside, live on these.
    void pins_changed(PortLetter port);
    /// The answer to the phase that twi_slave_phase() began comes no earlier; kNever while none is awaited.
    cosim::Time earliest_twi_slave_answer() const;

    /// Start of the frame that USART `unit` is shifting out and has not yet handed to Pins::uart_sent().
    std::optional<cosim::Time> uart_begun(int unit) const;
    const chip::UartCounters& uart_counters(int unit) const;
    /// RXENn: the receiver of `unit` listens.
    bool uart_listens(int unit) const;
    bool pin_level(Pin pin) const;

    const cosim::ClockDomain& clock() const;
    /// How far the chip has been run: the last `until`, or the start of the instruction at a stop address.
    cosim::Time now() const;
    Cycle cycle() const;
    std::uint32_t pc() const;  ///< byte address
    /// Symbols and source lines by byte address of flash, of the image loaded last.
    const image::CodePlaces& places() const;
    bool sleeping() const;
    /// Unless something comes in, the program does nothing and no pin changes before this time: now() while
    /// it runs, the next event while it sleeps, kNever if nothing will ever wake it.
    cosim::Time wakes() const;
    /// A register's stored value by data-sheet name. Throws std::out_of_range if there is none.
    std::uint8_t peek(std::string_view register_name) const;
    /// A register as the program would read it now, without side effects.
    std::uint8_t look(std::uint16_t address) const;
    /// A byte of RAM. Throws std::out_of_range elsewhere.
    std::uint8_t peek_data(std::uint16_t address) const;
    ChipReport report() const;
    /// What the program waits for, if it has done so for half a second or more and it cannot come.
    std::optional<std::string> hang() const;

    /// Everything that time changes, of a chip of the same device and options (base/states/archive.h). Throws
    /// StateError.
    void state(StateWriter& archive) const;
    void state(StateReader& archive);
    /// The same for a checkpoint (base/states/checkpoint.h), taken after mark(): flash and EEPROM stay out of
    /// it, their changes since the mark are taken back by rewind(), before the checkpoint is read. The mark
    /// stays until settle(). No stop address may be met or set between.
    void state(CheckpointWriter& archive) const;
    void state(CheckpointReader& archive);
    void mark();
    void rewind();
    void settle();

    /// What faults reach into (chip_faults.h), between two run_until().
    struct Inside {
        const DeviceInfo& device;
        Core& core;
        IoSpace& io;
        InterruptController& interrupts;
        cosim::ClockDomain& clock;
        Eeprom& eeprom;
        chip::HeldInterrupts& held;
    };
    /// What is done next happens at now().
    Inside inside();
    /// Replaces the stop addresses. Unlike stop_at(), allowed while a mark is set.
    void set_stops(const std::vector<std::uint32_t>& addresses);

    /// Busy-wait loops are skipped forward (default); off, every turn of them is executed.
    void set_skipping(bool on);
    /// Hot code is executed as the host's own; off, every instruction is interpreted (Core::set_translate()).
    void set_translating(bool on);

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace puckloop::avr
