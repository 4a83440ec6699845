#include "debug/places.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace puckloop::debug {

Places::Places(const std::map<std::string, image::Symbol>& symbols, image::LineTable lines)
    : lines_(std::move(lines)) {
    std::map<std::uint32_t, bool> global;
    for (const auto& [name, symbol] : symbols) {
        // Compilers' labels inside functions begin with ".L", the assembler's own have a control character.
        const bool label = name.empty() || name.front() == '.' ||
                           std::any_of(name.begin(), name.end(), [](char c) { return c > 0 && c < ' '; });
        if (symbol.space != image::Space::Program || label) continue;
        const auto [at, first] = functions_.try_emplace(symbol.address, name);
        if (first)
            global[symbol.address] = symbol.global;
        else if (symbol.global && !std::exchange(global[symbol.address], true))
            at->second = name;
    }
}

std::string_view Places::symbol_at(std::uint32_t address) const {
    const auto at = functions_.find(address);
    return at == functions_.end() ? std::string_view() : at->second;
}

const std::uint32_t* Places::function_of(std::uint32_t address) const {
    const auto after = functions_.upper_bound(address);
    return after == functions_.begin() ? nullptr : &std::prev(after)->first;
}

std::string Places::place(std::uint32_t address) const {
    const std::uint32_t* start = function_of(address);
    if (start == nullptr) return {};
    const std::string& name = functions_.at(*start);
    return *start == address ? name : fmt::format("{}+0x{:x}", name, address - *start);
}

}  // namespace puckloop::debug
