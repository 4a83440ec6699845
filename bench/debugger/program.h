#pragma once
// The program of a debugged chip as its writer knows it: functions, source lines, variables.

#include "debug/debug_chip.h"
#include "debug/places.h"
#include "emu/image/image.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::exec::debugger {

struct Variable {
    std::string name;           ///< without the underscore of C names on the dsPIC
    std::uint16_t address = 0;  ///< data address
    std::uint32_t bytes = 1;    ///< as the image states it, else up to the next symbol
    bool sized = false;         ///< the image states it
};

struct SourceLine {
    std::string file;        ///< without its folder; empty: unknown
    std::uint32_t line = 0;  ///< from 1
    friend bool operator==(const SourceLine&, const SourceLine&) = default;
};

class Program {
  public:
    /// `folders`: where source files are looked for, first ones first. The chip has the image loaded.
    Program(const image::Image& image, const image::LineTable& lines, const debug::DebugChip& chip,
            std::vector<std::filesystem::path> folders);

    const std::string& file() const { return file_; }
    bool has_lines() const { return !starts_.empty(); }

    /// Addresses of FILE:LINE (the next line with code where it has none), LINE of `current`, a function, or
    /// 0xADDRESS. Throws InputError, with the name that was meant.
    std::vector<std::uint32_t> addresses(std::string_view place, const std::string& current) const;
    /// The next line from `line` on that has code, and its addresses; none: there is no such file or line.
    std::optional<std::pair<std::uint32_t, std::vector<std::uint32_t>>> code_of(std::string_view file,
                                                                                std::uint32_t line) const;
    SourceLine line_of(std::uint32_t pc) const;
    /// The code of a line begins here.
    bool starts_line(std::uint32_t pc) const { return starts_.contains(pc); }
    /// Where lines begin within the function of `pc`.
    std::vector<std::uint32_t> line_starts(std::uint32_t pc) const;
    std::vector<std::uint32_t> all_line_starts() const;
    /// First address of the function of `pc`; itself where no symbol is known.
    std::uint32_t function_of(std::uint32_t pc) const;
    /// Its name as the source has it; empty: unknown.
    std::string function_name(std::uint32_t pc) const;
    /// "remember+0x10", "0x000104".
    std::string place(std::uint32_t pc) const;
    /// "0x000104 in remember+0x10 (lamp.c:21)".
    std::string where(std::uint32_t pc) const { return where(pc, pc); }
    /// With the line of another address.
    std::string where(std::uint32_t pc, std::uint32_t line_pc) const;
    /// Interrupts and traps lead here.
    bool is_interrupt_entry(std::uint32_t pc) const { return interrupt_entries_.contains(pc); }

    std::optional<Variable> variable(std::string_view name) const;
    std::vector<std::string> variable_names() const;
    std::vector<std::string> function_names() const;

    /// Where a source file is; empty: in no folder.
    std::filesystem::path source_file(const std::string& name) const;
    /// Its lines; empty: not found.
    const std::vector<std::string>& source(const std::string& name) const;

  private:
    std::string shown(std::string_view symbol) const;
    void read_vectors(const debug::DebugChip& chip);

    std::string file_;
    bool underscores_ = false;  ///< C names have one in front
    debug::Places places_;
    std::vector<std::filesystem::path> folders_;
    std::map<std::uint32_t, SourceLine> starts_;  ///< where a line's code begins
    std::set<std::uint32_t> interrupt_entries_;
    std::map<std::string, Variable, std::less<>> variables_;
    mutable std::map<std::string, std::vector<std::string>> sources_;
};

}  // namespace puckloop::exec::debugger
