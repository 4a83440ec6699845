#pragma once
// Program addresses in words of text: the symbol at or before an address.

#include "emu/image/image.h"

#include <cstdint>
#include <map>
#include <string>

namespace puckloop::image {

class CodeSymbols {
  public:
    /// The program symbols of an image; where several stand at one address, global ones first, then the first
    /// by name.
    explicit CodeSymbols(const Image& image) : CodeSymbols(image.symbols) {}
    explicit CodeSymbols(const std::map<std::string, Symbol>& symbols);

    /// "main", "main+0x12", or empty where no symbol lies at or before the address.
    std::string place(std::uint32_t address) const;

  private:
    std::map<std::uint32_t, std::string> names_;
};

}  // namespace puckloop::image
