#include "run/driven/board_access.h"

#include "base/error.h"
#include "base/suggest.h"
#include "emu/avr/devices/device.h"
#include "emu/image/avr_image.h"
#include "emu/image/image.h"
#include "emu/image/line_table.h"
#include "emu/image/symbol_sizes.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::tools {

namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::uint32_t kMostBytes = 0x10000;

std::string upper(std::string text) {
    for (char& c : text)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return text;
}

std::string hex_of(const std::vector<std::uint8_t>& bytes) {
    return fmt::format("{:02x}", fmt::join(bytes, ""));
}

std::vector<std::uint8_t> bytes_of(const std::string& hex) {
    std::vector<std::uint8_t> bytes;
    const auto digit = [&](char c) -> int {
        if (c >= '0' && c <= '9') return c - '0';
        if (c >= 'a' && c <= 'f') return c - 'a' + 10;
        if (c >= 'A' && c <= 'F') return c - 'A' + 10;
        return -1;
    };
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        const int high = digit(hex[i]), low = digit(hex[i + 1]);
        if (high < 0 || low < 0) break;
        bytes.push_back(static_cast<std::uint8_t>(high * 16 + low));
    }
    if (bytes.empty() || bytes.size() * 2 != hex.size())
        throw InputError("", "data", fmt::format("'{}' are no bytes", hex), "pairs of hexadecimal digits");
    return bytes;
}

/// What an image calls its places.
struct Names {
    std::map<std::string, image::Symbol> symbols;
    image::LineTable lines;
};

Names names_of(const std::string& file, bool avr) {
    if (!avr) return {image::load_image(file).symbols, image::source_lines(file)};
    image::AvrImage image =
        image::load_avr_image(file, puckloop::avr::find_device("atmega1284p")->image_part());
    return {std::move(image.symbols), std::move(image.lines)};
}

void check_fits(std::uint64_t value, int bits) {
    constexpr int kAll = 64;
    if (bits < kAll && (value >> bits) != 0)
        throw InputError("", "value", fmt::format("{} does not fit into {} bits", value, bits),
                         fmt::format("at most 0x{:x}", (std::uint64_t{1} << bits) - 1));
}

}  // namespace

BoardAccess::BoardAccess(DrivenNode& node, const std::string& file, bool avr)
    : node_(node), first_image_(file), avr_(avr), places_({}, {}) {
    read_names(file);
}

void BoardAccess::use_image(const std::string& file) {
    const std::string& wanted = file.empty() ? first_image_ : file;
    if (wanted != image_) read_names(wanted);
}

void BoardAccess::read_names(const std::string& file) {
    Names names = names_of(file, avr_);
    variables_.clear();
    const auto sizes = image::symbol_sizes(file);
    for (const auto& [name, symbol] : names.symbols) {
        if (symbol.space != image::Space::Data) continue;
        const auto size = sizes.find(name);
        const Variable variable{symbol.address, size == sizes.end() ? 0 : size->second};
        variables_[name] = variable;
        // A C variable carries an underscore, which nobody types.
        if (name.starts_with("_")) variables_.try_emplace(name.substr(1), variable);
    }
    places_ = debug::Places(names.symbols, std::move(names.lines));
    image_ = file;
}

/// From the beginning of the function on, where that is near: instructions have several lengths.
ordered_json BoardAccess::where() const {
    constexpr std::uint32_t kNear = 400;  // program addresses
    constexpr std::size_t kBefore = 6, kAfter = 10;
    const debug::DebugChip& chip = node_.chip();
    const std::uint32_t pc = chip.pc();
    const std::uint32_t* function = places_.function_of(pc);
    ordered_json instructions = ordered_json::array();
    std::size_t after = 0;
    for (std::uint32_t at = function != nullptr && pc - *function <= kNear ? *function : pc;
         after < kAfter && chip.is_code(at);) {
        if (at > pc && after == 0) {  // it was no beginning of an instruction
            at = pc;
            instructions.clear();
        }
        const debug::Instruction one = chip.instruction(at);
        instructions.push_back({{"pc", at}, {"text", one.text}, {"place", places_.symbol_at(at)}});
        after += at >= pc ? 1 : 0;
        if (after == 0 && instructions.size() > kBefore) instructions.erase(0);
        at += one.size;
    }
    ordered_json registers = ordered_json::array();
    std::vector<std::uint64_t> values(chip.registers().size());
    chip.read_registers(values);
    for (std::size_t i = 0; i < values.size(); ++i)
        registers.push_back(
            {{"name", chip.registers()[i].name}, {"bits", chip.registers()[i].bits}, {"value", values[i]}});
    ordered_json reply{{"pc", pc},
                       {"place", places_.place(pc)},
                       {"line", places_.lines().at(pc)},
                       {"asleep", chip.asleep()},
                       {"instructions", std::move(instructions)},
                       {"registers", std::move(registers)},
                       {"stack", stack()}};
    if (node_.interrupt_counts() != nullptr) reply["interrupts"] = interrupts();
    return reply;
}

/// What was pushed last comes first. A word that may lead back into the program has its place.
ordered_json BoardAccess::stack() const {
    constexpr int kShown = 16;
    constexpr std::uint32_t kWord = 2, kHighOfPc = 0x7F;
    const debug::DebugChip& chip = node_.chip();
    const bool up = chip.stack_grows_up();  // a dsPIC, whose words these are; else an AVR's bytes
    ordered_json words = ordered_json::array();
    const auto read = [&](std::uint32_t at, std::uint32_t& word) {
        std::uint8_t bytes[kWord] = {};
        if (at < chip.ram_start() || at + kWord > chip.ram_end() ||
            !chip.read_memory(debug::DebugChip::address_of_data(static_cast<std::uint16_t>(at)), bytes))
            return false;
        word = static_cast<std::uint32_t>(up ? bytes[0] | bytes[1] << 8 : bytes[0] << 8 | bytes[1]);
        return true;
    };
    const std::uint32_t top = chip.stack_pointer();
    for (int i = 0; i < kShown; ++i) {
        const auto step = static_cast<std::uint32_t>(i);
        const std::uint32_t at = up ? top - kWord * (step + 1) : top + 1 + step;
        std::uint32_t word = 0, high = 0;
        if (!read(at, word)) break;
        ordered_json row{{"address", at}, {"value", word}};
        // The return address of a call: low word, then the high bits (dsPIC); a word address (AVR).
        if (!up || (at >= kWord && read(at + kWord, high))) {
            const std::uint32_t pc = up ? (word & ~1U) | (high & kHighOfPc) << 16 : 2 * word;
            if (pc != 0 && chip.is_code(pc) && places_.function_of(pc) != nullptr)
                row["place"] = places_.place(pc);
        }
        words.push_back(std::move(row));
    }
    return words;
}

/// By how many there were.
ordered_json BoardAccess::interrupts() const {
    const DrivenNode::InterruptCounts& counts = *node_.interrupt_counts();
    const double seconds = cosim::to_seconds(node_.reached() - counts.from);
    std::vector<std::pair<std::uint64_t, int>> sorted;
    for (const auto& [vector, taken] : counts.taken)
        sorted.emplace_back(taken, vector);
    std::sort(sorted.rbegin(), sorted.rend());
    ordered_json list = ordered_json::array();
    for (const auto& [taken, vector] : sorted)
        list.push_back({{"name", node_.chip().vector_name(vector)},
                        {"count", taken},
                        {"per_s", seconds > 0 ? static_cast<double>(taken) / seconds : 0.0}});
    return list;
}

BoardAccess::Place BoardAccess::variable(const std::string& name) const {
    if (variables_.empty())
        throw InputError("", std::string(node_.name()), "its image has no symbols",
                         "an ELF or COFF image, or memory by address");
    const auto found = variables_.find(name);
    if (found == variables_.end()) {
        std::vector<std::string_view> known;
        for (const auto& one : variables_)
            known.push_back(one.first);
        throw InputError("", std::string(node_.name()), fmt::format("no variable '{}' in data memory", name),
                         "a variable of the image" + did_you_mean(name, known));
    }
    return {debug::DebugChip::address_of_data(static_cast<std::uint16_t>(found->second.address)),
            found->second.bytes};
}

BoardAccess::Place BoardAccess::place_of(const json& request) const {
    Place place;
    if (request.contains("variable")) {
        place = variable(request.at("variable").get<std::string>());
    } else {
        const auto address = request.at("memory").get<std::uint32_t>();
        if (address >= kMostBytes)
            throw InputError("", std::string(node_.name()), fmt::format("0x{:x} is no data address", address),
                             "0 to 0xffff");
        place = {debug::DebugChip::address_of_data(static_cast<std::uint16_t>(address)), 0};
    }
    if (const auto bytes = request.value("bytes", std::uint32_t{0}); bytes > 0) place.bytes = bytes;
    constexpr std::uint32_t kWord = 2;
    if (place.bytes == 0) place.bytes = node_.chip().architecture().empty() ? kWord : 1;
    if (place.bytes > kMostBytes)
        throw InputError("", "bytes", fmt::format("{} are too many", place.bytes), "at most 65536");
    return place;
}

ordered_json BoardAccess::read_register(std::string name) const {
    const debug::DebugChip& chip = node_.chip();
    name = upper(name);
    const auto registers = chip.registers();
    for (std::size_t i = 0; i < registers.size(); ++i)
        if (upper(registers[i].name) == name)
            return {{"value", chip.read_register(i)},
                    {"bits", registers[i].bits},
                    {"fields", ordered_json::object()}};
    const auto special = chip.special(name);
    if (!special) {
        const std::vector<std::string> names = chip.special_names();
        throw InputError("", std::string(node_.name()),
                         fmt::format("the {} has no register '{}'", chip.name(), name),
                         "a data-sheet name" + did_you_mean(name, {names.begin(), names.end()}));
    }
    ordered_json fields = ordered_json::object();
    for (const auto& field : special->fields)
        fields[field.name] = field.value;
    return {{"value", special->value},
            {"bits", special->bits},
            {"fields", fields},
            {"address", special->address}};
}

ordered_json BoardAccess::read_field(const std::string& name, const std::string& field) const {
    ordered_json reply = read_register(name);
    const ordered_json fields = reply.at("fields");
    if (!fields.contains(field)) {
        std::vector<std::string> known;
        for (const auto& one : fields.items())
            known.push_back(one.key());
        throw InputError("", std::string(node_.name()), fmt::format("{} has no field '{}'", name, field),
                         known.empty() ? "the whole register"
                                       : fmt::format("one of {}", fmt::join(known, ", ")));
    }
    reply["field"] = field;
    reply["value"] = fields.at(field);
    return reply;
}

ordered_json BoardAccess::read(const json& request) const {
    if (request.contains("field"))
        return read_field(request.at("register").get<std::string>(), request.at("field").get<std::string>());
    if (request.contains("register")) return read_register(request.at("register").get<std::string>());
    const Place place = place_of(request);
    std::vector<std::uint8_t> bytes(place.bytes);
    if (!node_.chip().read_memory(place.address, bytes))
        throw InputError("", std::string(node_.name()), "not all of these addresses exist",
                         "addresses of data memory");
    ordered_json reply{
        {"address", place.address & (kMostBytes - 1)}, {"bytes", place.bytes}, {"data", hex_of(bytes)}};
    std::uint64_t value = 0;
    for (std::size_t i = std::min(bytes.size(), sizeof value); i > 0; --i)
        value = value << 8 | bytes[i - 1];
    if (bytes.size() <= sizeof value) reply["value"] = value;
    return reply;
}

/// RAM at once; what may have the board send something, before the next instruction.
void BoardAccess::write_bytes(std::uint32_t address, const std::vector<std::uint8_t>& bytes) {
    debug::DebugChip& chip = node_.chip();
    std::vector<std::uint8_t> there(bytes.size());
    if (!chip.read_memory(address, there))
        throw InputError("", std::string(node_.name()), "not all of these addresses exist",
                         "addresses of data memory");
    const std::uint32_t data = address & (kMostBytes - 1);
    if (data >= chip.ram_start() && data + bytes.size() <= chip.ram_end())
        chip.write_memory(address, bytes);
    else
        node_.change_later([address, bytes](debug::DebugChip& later) { later.write_memory(address, bytes); });
}

void BoardAccess::write_register(std::string name, std::uint64_t value) {
    debug::DebugChip& chip = node_.chip();
    name = upper(name);
    const auto registers = chip.registers();
    for (std::size_t i = 0; i < registers.size(); ++i) {
        if (upper(registers[i].name) != name) continue;
        check_fits(value, registers[i].bits);
        if (!chip.write_register(i, value))
            throw InputError("", std::string(node_.name()), fmt::format("{} cannot be written", name));
        return;
    }
    const ordered_json there = read_register(name);
    std::vector<std::uint8_t> bytes;
    check_fits(value, there.at("bits").get<int>());
    for (int bit = 0; bit < there.at("bits").get<int>(); bit += 8)
        bytes.push_back(static_cast<std::uint8_t>(value >> bit));
    const auto address = static_cast<std::uint16_t>(there.at("address").get<std::uint32_t>());
    write_bytes(debug::DebugChip::address_of_data(address), bytes);
}

void BoardAccess::write(const json& request) {
    if (request.contains("field"))
        throw InputError("", std::string(node_.name()), "a field alone cannot be written", "its register");
    if (request.contains("register"))
        return write_register(request.at("register").get<std::string>(),
                              request.at("value").get<std::uint64_t>());
    Place place = place_of(request);
    std::vector<std::uint8_t> bytes;
    if (request.contains("data")) {
        bytes = bytes_of(request.at("data").get<std::string>());
    } else {
        const auto value = request.at("value").get<std::int64_t>();
        constexpr std::uint32_t kWidest = sizeof value;
        if (place.bytes > kWidest)
            throw InputError("", "value", fmt::format("{} bytes are no number", place.bytes),
                             "data in hexadecimal");
        if (value >= 0) check_fits(static_cast<std::uint64_t>(value), static_cast<int>(8 * place.bytes));
        for (std::uint32_t i = 0; i < place.bytes; ++i)
            bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    }
    write_bytes(place.address, bytes);
}

}  // namespace puckloop::tools
