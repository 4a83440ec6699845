#include "bench/debugger/dap_views.h"

#include "base/error.h"
#include "base/json.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::exec::debugger {

using nlohmann::json;

namespace {

constexpr std::size_t kMostStackFrames = 64;
constexpr std::uint32_t kMostElements = 4096;

std::string base64(const std::vector<std::uint8_t>& bytes) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (k < left ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += k <= left ? kDigits[group >> (18 - 6 * k) & 0x3F] : '=';
    }
    return text;
}

json variable(const std::string& name, const std::string& value, int reference) {
    return {{"name", name}, {"value", value}, {"variablesReference", reference}};
}

json with_memory(json object, const Place& place) {
    if (!place.core)
        object["memoryReference"] = fmt::format("0x{:06x}", debug::DebugChip::address_of_data(place.address));
    return object;
}

}  // namespace

json source(const Program& program, const std::string& file) {
    json object{{"name", file}};
    if (const auto path = program.source_file(file); !path.empty()) object["path"] = path.string();
    return object;
}

json stack_trace(Session& session, std::size_t first, std::size_t count) {
    const Program& program = session.program();
    const auto all = backtrace(session.chip(), program, kMostStackFrames);
    json list = json::array();
    for (std::size_t i = first; i < all.size() && (count == 0 || i < first + count); ++i) {
        const SourceLine line = program.line_of(all[i].line_pc);
        json frame{{"id", i + 1},
                   {"name", program.place(all[i].pc)},
                   {"line", line.line},
                   {"column", line.line == 0 ? 0 : 1},
                   {"instructionPointerReference", fmt::format("0x{:06x}", all[i].pc)}};
        if (line.line != 0) frame["source"] = source(program, line.file);
        list.push_back(frame);
    }
    return {{"stackFrames", list}, {"totalFrames", all.size()}};
}

json variables(Session& session, int reference) {
    const debug::DebugChip& chip = session.chip();
    const Program& program = session.program();
    json list = json::array();
    const std::vector<std::string> names = program.variable_names(), specials = chip.special_names();
    const int first_special = kFirstOpened + static_cast<int>(names.size());
    if (reference == kVariablesScope) {
        for (std::size_t i = 0; i < names.size(); ++i) {
            const Place place = place_of(names[i], chip, program);
            list.push_back(with_memory(variable(names[i], shown(place, chip, 0),
                                                place.integer ? 0 : kFirstOpened + static_cast<int>(i)),
                                       place));
        }
    } else if (reference == kCoreScope) {
        for (const debug::RegisterInfo& info : chip.registers())
            list.push_back(variable(info.name, shown(place_of(info.name, chip, program), chip, 'x'), 0));
    } else if (reference == kSpecialScope) {
        for (std::size_t i = 0; i < specials.size(); ++i) {
            const auto special = chip.special(specials[i]);
            if (special)
                list.push_back(variable(specials[i],
                                        fmt::format("0x{:0{}x}", special->value, special->bits / 4),
                                        special->fields.empty() ? 0 : first_special + static_cast<int>(i)));
        }
    } else if (reference >= first_special && reference < first_special + static_cast<int>(specials.size())) {
        if (const auto special = chip.special(specials[static_cast<std::size_t>(reference - first_special)]))
            for (const debug::DebugChip::Field& field : special->fields)
                list.push_back(variable(field.name, fmt::format("{}", field.value), 0));
    } else if (reference >= kFirstOpened && reference < first_special) {
        const std::string& name = names[static_cast<std::size_t>(reference - kFirstOpened)];
        const Place whole = place_of(name, chip, program);
        for (std::uint32_t i = 0; i < std::min(whole.bytes, kMostElements); ++i) {
            const Place place = place_of(fmt::format("{}[{}]", name, i), chip, program);
            list.push_back(with_memory(variable(fmt::format("[{}]", i), shown(place, chip, 0), 0), place));
        }
    }
    return {{"variables", list}};
}

json evaluated(Session& session, const std::string& expression) {
    const std::size_t first = expression.find_first_not_of(' ');
    const std::size_t last = expression.find_last_not_of(' ');
    if (first == std::string::npos) throw InputError("", "", "an empty expression", "a variable or register");
    const Place place =
        place_of(expression.substr(first, last - first + 1), session.chip(), session.program());
    return with_memory({{"result", shown(place, session.chip(), 0)}, {"variablesReference", 0}}, place);
}

json disassembled(Session& session, std::uint32_t address, std::int64_t offset, std::int64_t count) {
    const debug::DebugChip& chip = session.chip();
    const Program& program = session.program();
    // Back from `address`: instructions have one or two words, so they are counted from the function's begin.
    std::vector<std::uint32_t> before;
    std::uint32_t function = program.function_of(address);
    constexpr std::uint32_t kFarthest = 0x10000;
    if (address - function > kFarthest) function = address;  // what lies between is of no function
    for (std::uint32_t pc = function; pc < address && chip.is_code(pc); pc += chip.instruction(pc).size)
        before.push_back(pc);
    json list = json::array();
    const auto add_missing = [&](std::int64_t place) {
        list.push_back({{"address", fmt::format("0x{:06x}", std::max<std::int64_t>(place, 0))},
                        {"instruction", "?"},
                        {"presentationHint", "invalid"}});
    };
    const auto add = [&](std::uint32_t pc) {
        json one{{"address", fmt::format("0x{:06x}", pc)}, {"instruction", chip.instruction(pc).text}};
        if (!program.function_name(pc).empty() && program.function_of(pc) == pc)
            one["symbol"] = program.function_name(pc);
        if (const SourceLine line = program.line_of(pc); line.line != 0) {
            one["location"] = source(program, line.file);
            one["line"] = line.line;
        }
        list.push_back(one);
    };
    std::int64_t at = offset;
    for (; at < 0 && at < offset + count; ++at) {
        const std::int64_t index = static_cast<std::int64_t>(before.size()) + at;
        if (index < 0)
            add_missing(static_cast<std::int64_t>(function) + 2 * index);
        else
            add(before[static_cast<std::size_t>(index)]);
    }
    std::uint32_t pc = address;
    for (std::int64_t i = 0; i < offset + count; ++i) {
        const bool exists = chip.is_code(pc);
        if (i >= offset && exists) add(pc);
        if (i >= offset && !exists) add_missing(pc);
        pc += exists ? chip.instruction(pc).size : 2;
    }
    return {{"instructions", list}};
}

json memory(Session& session, std::uint32_t address, std::uint32_t count) {
    std::vector<std::uint8_t> bytes;
    for (std::uint32_t i = 0; i < count; ++i) {
        std::uint8_t byte = 0;
        if (!session.chip().read_memory(address + i, {&byte, 1})) break;
        bytes.push_back(byte);
    }
    json object{{"address", fmt::format("0x{:06x}", address)}, {"data", base64(bytes)}};
    if (bytes.size() < count) object["unreadableBytes"] = count - bytes.size();
    return object;
}

}  // namespace puckloop::exec::debugger
