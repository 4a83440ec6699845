#pragma once
// What a debugger sees of a chip, whatever its family: registers in GDB's order, memory by GDB's addresses,
// instructions as text. One class a family implements it. All of it happens between two runs.

#include "emu/chip/instrument.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::avr {
class Chip;
}
namespace puckloop::dspic {
class Chip;
}

namespace puckloop::debug {

struct RegisterInfo {
    std::string name;
    int bits = 8;             ///< a multiple of 8, at most 64
    std::string_view type{};  ///< as a target description takes it: "uint8", "code_ptr", "data_ptr"
};

enum class Flow : std::uint8_t { Other, Call, Return, InterruptReturn };

struct Instruction {
    std::string text;
    std::uint32_t size = 2;  ///< program addresses it takes
    Flow flow = Flow::Other;
};

class DebugChip {
  public:
    virtual ~DebugChip() = default;

    /// The family's name for GDB's <architecture>; empty: GDB has none.
    virtual std::string_view architecture() const = 0;
    virtual std::string_view name() const = 0;  ///< of the part
    virtual std::span<const RegisterInfo> registers() const = 0;
    /// All of them; `values` has room for each.
    virtual void read_registers(std::span<std::uint64_t> values) const = 0;
    std::uint64_t read_register(std::size_t number) const {
        std::vector<std::uint64_t> values(registers().size());
        read_registers(values);
        return values[number];
    }
    /// False: it cannot be written.
    virtual bool write_register(std::size_t number, std::uint64_t value) = 0;

    /// False: not all of these addresses exist. Reading has no side effects.
    virtual bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const = 0;
    /// Data registers have theirs, as if the program wrote. What exists before a wrong address is written.
    virtual bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) = 0;
    /// The address in data space that a debugger's address is, if it is one: from 0x800000 on, as avr-gdb has
    /// it.
    static std::optional<std::uint16_t> data_address(std::uint32_t address) {
        if (address < kData || address >= kData + kDataSpace) return std::nullopt;
        return static_cast<std::uint16_t>(address - kData);
    }
    /// The other way round.
    static std::uint32_t address_of_data(std::uint16_t data) { return kData + data; }
    /// First and behind the last data address of RAM.
    virtual std::uint32_t ram_start() const = 0;
    virtual std::uint32_t ram_end() const = 0;
    /// Others than the program write this byte of RAM too (DMA).
    virtual bool shared(std::uint16_t /*data*/) const { return false; }
    /// The stack grows to higher addresses (dsPIC), or to lower ones (AVR).
    virtual bool stack_grows_up() const = 0;

    virtual std::uint32_t pc() const = 0;  ///< program address; AVR: in bytes
    virtual std::uint16_t stack_pointer() const = 0;
    virtual std::uint64_t cycle() const = 0;  ///< at which the next instruction begins
    virtual std::uint64_t instructions() const = 0;
    /// The next instruction is a further iteration of a repeated one.
    virtual bool repeating() const { return false; }
    virtual bool asleep() const = 0;
    virtual Instruction instruction(std::uint32_t pc) const = 0;
    /// Whether a breakpoint can stand there.
    virtual bool is_code(std::uint32_t pc) const = 0;
    /// The data sheet's name of what an interrupt vector serves.
    virtual std::string vector_name(int vector) const = 0;

    struct Field {
        std::string name;
        std::uint32_t value = 0;
        int low = 0;   ///< its lowest bit
        int bits = 1;  ///< how many
    };
    struct Special {
        std::uint32_t value = 0;
        std::uint32_t address = 0;  ///< data address
        int bits = 8;
        std::vector<Field> fields;  ///< those that the register table names
    };
    /// A register by its data-sheet name, as the program would read it, without side effects.
    virtual std::optional<Special> special(std::string_view name) const = 0;
    virtual std::vector<std::string> special_names() const = 0;

    /// Replaces the addresses at which a run ends early.
    virtual void set_stops(std::span<const std::uint32_t> addresses) = 0;
    virtual void set_instrument(chip::Instrument* instrument, bool accesses) = 0;

  private:
    static constexpr std::uint32_t kData = 0x800000, kDataSpace = 0x10000;
};

/// The chip must outlive it.
std::unique_ptr<DebugChip> make_debug_chip(avr::Chip& chip);
std::unique_ptr<DebugChip> make_debug_chip(dspic::Chip& chip);

}  // namespace puckloop::debug
