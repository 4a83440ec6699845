#include "replay/watch.h"

#include "base/error.h"
#include "base/text/suggest.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>

namespace puckloop::tools {

using chip::MemoryPlace;
using chip::MemorySpace;
using cosim::Time;

namespace {

constexpr std::uint32_t kMostBytes = 8, kBitsOfByte = 8;

/// Decimal or 0x; nothing for anything else.
std::optional<std::uint32_t> number_of(std::string_view text) {
    const bool hex = text.starts_with("0x") || text.starts_with("0X");
    if (hex) text.remove_prefix(2);
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, hex ? 16 : 10);
    if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// By its name in C, where the symbol may carry an underscore.
const Variable* find_variable(const std::map<std::string, Variable>& variables, const std::string& name) {
    for (const std::string& symbol : {name, "_" + name})
        if (const auto found = variables.find(symbol); found != variables.end()) return &found->second;
    return nullptr;
}

}  // namespace

Watch::Watch(ChipView view, const std::vector<std::string>& names) : view_(std::move(view)) {
    for (const std::string& name : names)
        add(name);
}

void Watch::refuse(const std::string& name) const {
    std::vector<std::string> known{"PC"};
    for (std::uint32_t i = 0; i < view_.chip->cells(MemorySpace::Register); ++i)
        known.emplace_back(view_.chip->name(view_.chip->cell(MemorySpace::Register, i)));
    for (const auto& [symbol, variable] : view_.variables)
        known.push_back(symbol.starts_with('_') ? symbol.substr(1) : symbol);
    const std::string near = nearest_name(name, {known.begin(), known.end()});
    throw InputError(
        "", "--registers", fmt::format("'{}' is neither a register nor a variable of {}", name, view_.name),
        near.empty() ? std::string(view_.variables.empty()
                                       ? "one that --list-registers shows; the firmware's file has no symbols"
                                       : "one that --list-registers shows")
                     : fmt::format("'{}', or another that --list-registers shows", near));
}

bool Watch::add_register(const std::string& name) {
    Source source;
    if (name == "PC") {
        source.is_pc = true;
    } else if (const auto place = view_.chip->find_register(name)) {
        source.registers = {*place};
    } else {
        const auto low = view_.chip->find_register(name + "L"), high = view_.chip->find_register(name + "H");
        if (view_.cell_bytes != 1 || !low || !high) return false;
        source.registers = {*low, *high};
    }
    constexpr unsigned kPcBits = 24;
    const auto cells = static_cast<unsigned>(source.registers.size());
    values_.push_back({name, source.is_pc ? kPcBits : cells * view_.cell_bytes * kBitsOfByte});
    sources_.push_back(std::move(source));
    return true;
}

void Watch::add(const std::string& text) {
    if (add_register(text)) return;
    const std::size_t colon = text.rfind(':');
    const std::string place = text.substr(0, colon);
    const std::size_t plus = place.rfind('+');
    const std::string name = place.substr(0, plus);
    const Variable* variable = find_variable(view_.variables, name);
    const bool has_offset = plus != std::string::npos;
    const auto offset = has_offset ? number_of(place.substr(plus + 1)) : 0;
    const auto address = variable ? std::optional(variable->address) : number_of(name);
    if (!address || !offset) refuse(text);
    Source source;
    source.address = *address + *offset;
    source.bytes = view_.cell_bytes;
    if (variable && !has_offset && variable->size > 0 && variable->size <= kMostBytes)
        source.bytes = variable->size;
    if (colon != std::string::npos) {
        const auto bytes = number_of(text.substr(colon + 1));
        if (!bytes || *bytes == 0 || *bytes > kMostBytes)
            throw InputError("", "--registers",
                             fmt::format("'{}': '{}' is no number of bytes", text, text.substr(colon + 1)),
                             "1 to 8");
        source.bytes = *bytes;
    }
    for (std::uint32_t i = 0; i < source.bytes; ++i) {
        const std::uint32_t at = source.address + i;
        if (view_.chip->bits({MemorySpace::Ram, at - at % view_.cell_bytes}) == 0)
            throw InputError("", "--registers",
                             fmt::format("'{}': there is no RAM at 0x{:04x} of {}", text, at, view_.name),
                             "a data address of its RAM");
    }
    values_.push_back({text, source.bytes * kBitsOfByte});
    sources_.push_back(source);
}

Time Watch::next(Time now) const {
    if (now < view_.origin) return view_.origin;
    const std::uint64_t cycle = view_.clock->first_cycle_at(now - view_.origin + 1);
    return std::max(now + 1, view_.origin + view_.clock->time_of(cycle));
}

std::uint8_t Watch::ram_byte(std::uint32_t address) const {
    const std::uint32_t within = address % view_.cell_bytes;
    const std::uint32_t cell = view_.chip->read({MemorySpace::Ram, address - within});
    return static_cast<std::uint8_t>(cell >> (kBitsOfByte * within));
}

std::uint64_t Watch::read(const Source& source) const {
    if (source.is_pc) return view_.chip->pc();
    std::uint64_t value = 0;
    if (!source.registers.empty()) {
        for (std::size_t i = source.registers.size(); i-- > 0;)
            value = value << kBitsOfByte * view_.cell_bytes | view_.chip->read(source.registers[i]);
        return value;
    }
    for (std::uint32_t i = source.bytes; i-- > 0;)
        value = value << kBitsOfByte | ram_byte(source.address + i);
    return value;
}

void Watch::sample(Time now) {
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        const std::uint64_t value = read(sources_[i]);
        if (sources_[i].last == value) continue;
        sources_[i].last = value;
        log_.add({now, value, i});
    }
}

std::string list_of(const ChipView& view) {
    std::string text = fmt::format("{}: PC, program counter\n", view.name);
    for (std::uint32_t i = 0; i < view.chip->cells(MemorySpace::Register); ++i) {
        const MemoryPlace place = view.chip->cell(MemorySpace::Register, i);
        text += fmt::format("{} register, bits 0x{:0{}x}\n", view.chip->name(place), view.chip->bits(place),
                            2 * view.cell_bytes);
    }
    for (const auto& [name, variable] : view.variables)
        if (view.chip->bits({MemorySpace::Ram, variable.address - variable.address % view.cell_bytes}) != 0)
            text += fmt::format("{} variable at 0x{:04x}{}\n", name, variable.address,
                                variable.size == 0 ? "" : fmt::format(", {} bytes", variable.size));
    return text;
}

}  // namespace puckloop::tools
