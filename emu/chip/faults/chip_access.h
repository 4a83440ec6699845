#pragma once
// What a fault can do to a chip, whatever its family; each family implements it (emu/dspic/chip, emu/avr).
// All of it happens between two runs of the chip, at the time that it has been run to.

#include "cosim/core/time.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace puckloop::chip {

enum class FaultReset : std::uint8_t {
    PowerOn,
    BrownOut,
    External,  ///< MCLR, RESET pin
    Watchdog,
    Software,       ///< dsPIC only, as the next two
    Trap,           ///< trap conflict
    IllegalOpcode,  ///< or an uninitialised W register
};
/// "power_on", "brown_out", "mclr", "watchdog", "software", "trap", "illegal_opcode", in this order.
std::span<const std::string_view> reset_cause_names();
std::optional<FaultReset> reset_cause_of_name(std::string_view name);

enum class MemorySpace : std::uint8_t { Ram, Register, Flash, Eeprom };
/// "ram", "register", "flash", "eeprom", in this order.
std::span<const std::string_view> memory_space_names();
std::optional<MemorySpace> memory_space_of_name(std::string_view name);

/// One cell of a memory: a word, or a byte on an AVR's data space and EEPROM.
struct MemoryPlace {
    MemorySpace space = MemorySpace::Ram;
    std::uint32_t address =
        0;  ///< data address; program address (AVR: in bytes); EEPROM as the family counts
};
/// When an interrupt comes whose event is at `now`: then, later, or (kNever) not at all.
using InterruptTime = std::function<cosim::Time(int vector, cosim::Time now)>;

class ChipAccess {
  public:
    virtual ~ChipAccess() = default;

    virtual std::uint32_t pc() const = 0;
    /// The run ended early at a stop address.
    virtual bool stopped() const = 0;
    /// Replaces the addresses at which a run ends early (program addresses; AVR: bytes).
    virtual void set_stops(std::span<const std::uint32_t> addresses) = 0;

    virtual bool knows(FaultReset cause) const = 0;
    /// With the cause's flags in RCON or MCUSR; a core that hangs runs again.
    virtual void reset(FaultReset cause) = 0;
    /// The core executes nothing before `until`, unless a reset comes; everything else goes on.
    virtual void hang(cosim::Time until) = 0;
    /// From now on the clock is off by `ppm`, the part's own error included; within +-90 000.
    virtual void set_ppm(double ppm) = 0;

    /// How many cells a memory has, and the i-th; registers: those that a model is behind.
    virtual std::uint32_t cells(MemorySpace space) const = 0;
    virtual MemoryPlace cell(MemorySpace space, std::uint32_t i) const = 0;
    /// A register by its data-sheet name.
    virtual std::optional<MemoryPlace> find_register(std::string_view name) const = 0;
    /// Bits of the cell that exist; 0: there is no such cell.
    virtual std::uint32_t bits(const MemoryPlace& place) const = 0;
    virtual std::uint32_t read(const MemoryPlace& place) const = 0;
    /// Inverts the bits in `mask`. What a register controls follows.
    virtual void flip(const MemoryPlace& place, std::uint32_t mask) = 0;
    /// Reads a firmware image that is to be programmed later, or named again after a state was loaded. Throws
    /// InputError: unreadable, not for this chip, or with another SHA-256 than the one given (empty: any).
    virtual void read_image(const std::string& file, const std::string& sha256) = 0;
    /// Writes such an image as a programmer at the board's connector does, in no time: the memories are
    /// erased before. RAM and registers stay as they are. Reports name places by it from now on.
    virtual void program(const std::string& file) = 0;
    /// What was programmed before a state was saved that was loaded now: reports name places by it.
    virtual void name_places(const std::string& file) = 0;

    /// The name of a register's place, for reports; empty for another place.
    virtual std::string_view name(const MemoryPlace& place) const = 0;

    /// By the data sheet's name of its source: "U2RX", "TIMER0_OVF".
    virtual std::optional<int> vector(std::string_view source) const = 0;
    /// The source requests, as if it had something to report. False: it cannot now, nothing happens.
    virtual bool interrupt(int vector) = 0;
    /// From now on `when` is asked at every event of these sources that would begin a request; for the
    /// chip's life.
    virtual void watch_interrupts(std::span<const int> vectors, InterruptTime when) = 0;
};

}  // namespace puckloop::chip
