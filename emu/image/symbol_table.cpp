#include "emu/image/symbol_table.h"

#include <fmt/format.h>

#include <iterator>

namespace puckloop::image {

CodeSymbols::CodeSymbols(const std::map<std::string, Symbol>& symbols) {
    for (const bool global : {true, false})
        for (const auto& [name, symbol] : symbols)
            if (symbol.space == Space::Program && symbol.global == global)
                names_.emplace(symbol.address, name);
}

std::string CodeSymbols::place(std::uint32_t address) const {
    const auto above = names_.upper_bound(address);
    if (above == names_.begin()) return {};
    const auto& [start, name] = *std::prev(above);
    return address == start ? name : fmt::format("{}+0x{:x}", name, address - start);
}

}  // namespace puckloop::image
