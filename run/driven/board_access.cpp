#include "run/driven/board_access.h"

#include "base/error.h"
#include "base/json.h"
#include "debug/core_register.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::tools {

namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::uint32_t kMostBytes = ChipValues::kDataBytes;

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

void check_fits(std::uint64_t value, int bits) {
    constexpr int kAll = 64;
    if (bits < kAll && (value >> bits) != 0)
        throw InputError("", "value", fmt::format("{} does not fit into {} bits", value, bits),
                         fmt::format("at most 0x{:x}", (std::uint64_t{1} << bits) - 1));
}

}  // namespace

BoardAccess::BoardAccess(DrivenNode& node, const std::string& file)
    : node_(node), first_image_(file), values_(node.chip(), std::string(node.name()), file) {}

void BoardAccess::use_image(const std::string& file) {
    const std::string& wanted = file.empty() ? first_image_ : file;
    if (wanted != values_.image()) values_.use_image(wanted);
}

/// From the beginning of the function on, where that is near: instructions have several lengths.
ordered_json BoardAccess::where() const {
    constexpr std::uint32_t kNear = 400;  // program addresses
    constexpr std::size_t kBefore = 6, kAfter = 10;
    const debug::DebugChip& chip = node_.chip();
    const debug::Places& places = values_.places();
    const std::uint32_t pc = chip.pc();
    const std::uint32_t* function = places.function_of(pc);
    ordered_json instructions = ordered_json::array();
    std::size_t after = 0;
    for (std::uint32_t at = function != nullptr && pc - *function <= kNear ? *function : pc;
         after < kAfter && chip.is_code(at);) {
        if (at > pc && after == 0) {  // it was no beginning of an instruction
            at = pc;
            instructions.clear();
        }
        const debug::Instruction one = chip.instruction(at);
        instructions.push_back({{"pc", at}, {"text", one.text}, {"place", places.symbol_at(at)}});
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
                       {"place", places.place(pc)},
                       {"line", places.lines().at(pc)},
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
    const debug::Places& places = values_.places();
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
            if (pc != 0 && chip.is_code(pc) && places.function_of(pc) != nullptr)
                row["place"] = places.place(pc);
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

void BoardAccess::write_register(const std::string& name, std::uint64_t value) {
    debug::DebugChip& chip = node_.chip();
    if (const auto core = debug::core_register(name, chip)) {
        check_fits(value, chip.registers()[*core].bits);
        if (!chip.write_register(*core, value))
            throw InputError("", std::string(node_.name()),
                             fmt::format("{} cannot be written", debug::upper_case(name)));
        return;
    }
    const ordered_json there = values_.read_register(name);
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
    const ChipValues::Place place = values_.place_of(request);
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
