#include "bench/debugger/program.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "emu/image/line_table.h"
#include "emu/image/symbol_sizes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <system_error>

namespace puckloop::exec::debugger {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kMostBytes = 0x10000;

std::optional<std::uint32_t> number_in(std::string_view text, int base) {
    std::uint32_t value = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value, base);
    if (text.empty() || error != std::errc{} || end != last) return std::nullopt;
    return value;
}

/// Names of the data symbols by address; of several at one address the first.
std::map<std::uint32_t, std::string> data_symbols(const image::Image& image, std::uint32_t ram_end) {
    std::map<std::uint32_t, std::string> names;
    for (const auto& [name, symbol] : image.symbols)
        if (symbol.space == image::Space::Data && symbol.address < ram_end && !name.empty() &&
            name.front() != '.')
            names.try_emplace(symbol.address, name);
    return names;
}

}  // namespace

Program::Program(const image::Image& image, const image::LineTable& lines, const debug::DebugChip& chip,
                 std::vector<fs::path> folders)
    : file_(image.file),
      underscores_(chip.stack_grows_up()),
      places_(image.symbols, lines),
      folders_(std::move(folders)) {
    for (const image::LineTable::Stretch& stretch : places_.lines().stretches())
        starts_[stretch.address] = {std::string(stretch.file), stretch.line};
    const auto sizes = image::symbol_sizes(image.file);
    const auto names = data_symbols(image, chip.ram_end());
    for (const auto& [name, symbol] : image.symbols) {
        if (symbol.space != image::Space::Data || symbol.address >= chip.ram_end() || name.empty() ||
            name.front() == '.')
            continue;
        Variable variable{shown(name), static_cast<std::uint16_t>(symbol.address), 1, false};
        if (const auto size = sizes.find(name); size != sizes.end() && size->second > 0) {
            variable.bytes = std::min(size->second, kMostBytes);
            variable.sized = true;
        } else if (const auto next = names.upper_bound(symbol.address); next != names.end()) {
            variable.bytes = next->first - symbol.address;
        }
        variables_.try_emplace(variable.name, variable);
    }
    read_vectors(chip);
}

void Program::read_vectors(const debug::DebugChip& chip) {
    if (chip.stack_grows_up()) {  // the dsPIC's tables hold addresses
        constexpr std::uint32_t kFirst = 0x04, kEnd = 0x200;
        for (std::uint32_t at = kFirst; at < kEnd; at += 2) {
            std::uint8_t bytes[4] = {};
            if (!chip.read_memory(0x1000000 + 2 * at, bytes)) continue;
            const auto entry = static_cast<std::uint32_t>(bytes[0] | bytes[1] << 8 | bytes[2] << 16);
            if (entry >= kEnd && chip.is_code(entry)) interrupt_entries_.insert(entry);
        }
    } else {  // the AVR's hold jumps
        constexpr std::uint32_t kVectors = 35, kBytes = 4;
        for (std::uint32_t vector = 1; vector < kVectors; ++vector)
            interrupt_entries_.insert(vector * kBytes);
    }
}

std::string Program::shown(std::string_view symbol) const {
    if (underscores_ && symbol.size() > 1 && symbol.front() == '_') symbol.remove_prefix(1);
    return std::string(symbol);
}

std::optional<std::pair<std::uint32_t, std::vector<std::uint32_t>>>
Program::code_of(std::string_view file, std::uint32_t line) const {
    file = file.substr(file.find_last_of('/') + 1);
    std::uint32_t nearest = 0;
    for (const auto& [address, start] : starts_)
        if (start.file == file && start.line >= line && (nearest == 0 || start.line < nearest))
            nearest = start.line;
    if (nearest == 0) return std::nullopt;
    std::vector<std::uint32_t> found;
    for (const std::uint32_t address : places_.lines().addresses(file, nearest)) {
        // One stop for each function: a line's code may lie in several pieces.
        const bool known = std::any_of(found.begin(), found.end(), [&](std::uint32_t other) {
            return function_of(other) == function_of(address);
        });
        if (!known) found.push_back(address);
    }
    return std::pair{nearest, found};
}

std::vector<std::uint32_t> Program::addresses(std::string_view place, const std::string& current) const {
    if (place.starts_with("*")) place.remove_prefix(1);
    const std::size_t colon = place.rfind(':');
    const auto line_number = number_in(colon == std::string_view::npos ? place : place.substr(colon + 1), 10);
    if (line_number && (colon != std::string_view::npos || !current.empty() || !place.starts_with("0"))) {
        const std::string file =
            colon == std::string_view::npos ? current : std::string(place.substr(0, colon));
        if (const auto code = code_of(file, *line_number)) return code->second;
        if (!has_lines())
            throw InputError(file_, "", "the image has no source lines",
                             "an ELF or COFF image with them, or a symbol");
        std::set<std::string_view> files;
        for (const auto& [address, start] : starts_)
            files.insert(start.file);
        if (files.contains(file.substr(file.find_last_of('/') + 1)))
            throw InputError("", "", fmt::format("{} has no code from line {} on", file, *line_number), "");
        throw InputError("", "", fmt::format("no source file '{}' in the image", file),
                         "one with code" + did_you_mean(file, {files.begin(), files.end()}));
    }
    if (place.starts_with("0x") || place.starts_with("0X")) {
        constexpr std::uint32_t kHighest = 0x7FFFFE;
        const auto address = number_in(place.substr(2), 16);
        if (!address || *address % 2 != 0 || *address > kHighest)
            throw InputError("", "", fmt::format("'{}' is no program address", place),
                             "an even one, such as 0x1f48");
        return {*address};
    }
    for (const auto& [address, name] : places_.functions())
        if (name == place || shown(name) == place) return {address};
    std::vector<std::string> names = function_names();
    throw InputError("", "", fmt::format("no function '{}'", place),
                     "FILE:LINE, a function or 0xADDRESS" +
                         did_you_mean(place, {names.begin(), names.end()}));
}

SourceLine Program::line_of(std::uint32_t pc) const {
    const std::string text = places_.lines().at(pc);
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos) return {};
    return {text.substr(0, colon), number_in(std::string_view(text).substr(colon + 1), 10).value_or(0)};
}

std::vector<std::uint32_t> Program::line_starts(std::uint32_t pc) const {
    const std::uint32_t first = function_of(pc);
    const auto next = places_.functions().upper_bound(pc);
    const auto last = next == places_.functions().end() ? starts_.end() : starts_.lower_bound(next->first);
    std::vector<std::uint32_t> found;
    for (auto at = starts_.lower_bound(first); at != last; ++at)
        found.push_back(at->first);
    return found;
}

std::vector<std::uint32_t> Program::all_line_starts() const {
    std::vector<std::uint32_t> found;
    for (const auto& [address, line] : starts_)
        found.push_back(address);
    return found;
}

std::uint32_t Program::function_of(std::uint32_t pc) const {
    const std::uint32_t* start = places_.function_of(pc);
    return start == nullptr ? pc : *start;
}

std::string Program::function_name(std::uint32_t pc) const {
    return shown(places_.symbol_at(function_of(pc)));
}

std::string Program::place(std::uint32_t pc) const {
    const std::string text = places_.place(pc);
    return text.empty() ? fmt::format("0x{:06x}", pc) : shown(text);
}

std::string Program::where(std::uint32_t pc, std::uint32_t line_pc) const {
    std::string text = fmt::format("0x{:06x}", pc);
    if (!places_.place(pc).empty()) text += " in " + place(pc);
    if (const std::string line = places_.lines().at(line_pc); !line.empty()) text += " (" + line + ")";
    return text;
}

std::optional<Variable> Program::variable(std::string_view name) const {
    const auto found = variables_.find(name);
    return found == variables_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::string> Program::variable_names() const {
    std::vector<std::string> names;
    for (const auto& [name, variable] : variables_)
        names.push_back(name);
    return names;
}

std::vector<std::string> Program::function_names() const {
    std::vector<std::string> names;
    for (const auto& [address, name] : places_.functions())
        names.push_back(shown(name));
    std::sort(names.begin(), names.end());
    return names;
}

fs::path Program::source_file(const std::string& name) const {
    std::error_code error;
    for (const fs::path& folder : folders_)
        if (const fs::path file = folder / name; fs::is_regular_file(file, error)) return fs::absolute(file);
    return {};
}

const std::vector<std::string>& Program::source(const std::string& name) const {
    const auto [at, first] = sources_.try_emplace(name);
    if (!first) return at->second;
    if (const fs::path file = source_file(name); !file.empty()) {
        std::ifstream lines(file);
        for (std::string line; std::getline(lines, line);)
            at->second.push_back(line);
    }
    return at->second;
}

}  // namespace puckloop::exec::debugger
