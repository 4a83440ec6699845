#pragma once
// Where in the program an address lies, for reports: symbol and source line. The lines are read from the
// image's file when the first one is asked for, so that a program that behaves costs nothing.

#include "emu/image/line_table.h"
#include "emu/image/symbol_table.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace puckloop::image {

class CodePlaces {
  public:
    CodePlaces() = default;
    /// `file` as the image names it and `sha256` of its bytes: a file that is gone or another one by now has
    /// no lines.
    CodePlaces(const std::map<std::string, Symbol>& symbols, std::string file, std::string sha256);

    /// "main", "main+0x12", or empty where no symbol lies at or before the address.
    std::string symbol(std::uint32_t address) const { return symbols_.place(address); }
    /// "main.c:12", or empty where no compiler noted one.
    std::string line(std::uint32_t address) const;
    /// " in main+0x12 (main.c:12)", without what is not known.
    std::string text(std::uint32_t address) const;

  private:
    CodeSymbols symbols_{std::map<std::string, Symbol>{}};
    std::string file_, sha256_;
    mutable std::optional<LineTable> lines_;
};

}  // namespace puckloop::image
