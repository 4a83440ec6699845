#pragma once
// Registers and variables of a chip that are looked at after every instruction cycle, and their changes.
//
// A change has the time at which the instruction that made it ends and the next one begins. Looking has no
// side effects: a register reads as the program would read it, and no flag is cleared by that.

#include "replay/chip_view.h"
#include "replay/value_log.h"

#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

class Watch {
  public:
    struct Value {
        std::string name;
        unsigned bits = 0;
    };

    /// `names`: a register by its data-sheet name ("PORTB"; an AVR's pairs too, "TCNT1"), "PC", a variable
    /// of the firmware, or an address of RAM ("0x0850"); the latter two with "+OFFSET" and ":BYTES" (1 to 8)
    /// where wanted. Throws InputError naming --registers.
    Watch(ChipView view, const std::vector<std::string>& names);

    const std::vector<Value>& values() const { return values_; }
    /// Before this the chip's values mean nothing.
    cosim::Time first() const { return view_.lives_from; }
    /// Start of the chip's next instruction cycle, in the run's time.
    cosim::Time next(cosim::Time now) const;
    void sample(cosim::Time now);
    ValueLog& log() { return log_; }

  private:
    struct Source {
        bool is_pc = false;
        std::vector<chip::MemoryPlace> registers;  ///< the lowest bits first
        std::uint32_t address = 0, bytes = 0;      ///< of RAM, without registers
        std::optional<std::uint64_t> last;
    };
    void add(const std::string& text);
    bool add_register(const std::string& name);
    std::uint8_t ram_byte(std::uint32_t address) const;
    std::uint64_t read(const Source& source) const;
    [[noreturn]] void refuse(const std::string& name) const;

    ChipView view_;
    std::vector<Value> values_;
    std::vector<Source> sources_;
    ValueLog log_;
};

/// What Watch takes, one a line: name, bits or bytes, and the address of variables.
std::string list_of(const ChipView& view);

}  // namespace puckloop::tools
