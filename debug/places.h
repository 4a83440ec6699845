#pragma once
// Names for program addresses: functions of the image's symbols, source lines where it has them.

#include "emu/image/image.h"
#include "emu/image/line_table.h"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace puckloop::debug {

class Places {
  public:
    Places(const std::map<std::string, image::Symbol>& symbols, image::LineTable lines);

    /// Without program symbols functions are known by where calls lead only.
    bool has_symbols() const { return !functions_.empty(); }
    /// Name of the symbol at `address`, or an empty one.
    std::string_view symbol_at(std::uint32_t address) const;
    /// Address of the last symbol at or before `address`; nothing: none is.
    const std::uint32_t* function_of(std::uint32_t address) const;
    /// "main", "main+0x12", or empty.
    std::string place(std::uint32_t address) const;
    const image::LineTable& lines() const { return lines_; }
    /// Every function's address and name.
    const std::map<std::uint32_t, std::string>& functions() const { return functions_; }

  private:
    std::map<std::uint32_t, std::string> functions_;
    image::LineTable lines_;
};

}  // namespace puckloop::debug
