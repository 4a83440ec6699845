#include "run/chips/chip_values.h"

#include "base/error.h"
#include "base/json.h"
#include "base/text/suggest.h"
#include "debug/core_register.h"
#include "emu/image/symbol_sizes.h"
#include "run/chips/image_names.h"

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

std::string hex_of(const std::vector<std::uint8_t>& bytes) {
    return fmt::format("{:02x}", fmt::join(bytes, ""));
}

}  // namespace

ChipValues::ChipValues(const debug::DebugChip& chip, std::string node, const std::string& firmware)
    : chip_(chip), node_(std::move(node)), places_({}, {}) {
    use_image(firmware);
}

ChipValues::Place ChipValues::variable(const std::string& name) const {
    if (variables_.empty())
        throw InputError("", node_, "its image has no symbols", "an ELF or COFF image, or memory by address");
    const auto found = variables_.find(name);
    if (found == variables_.end()) {
        std::vector<std::string_view> known;
        for (const auto& one : variables_)
            known.push_back(one.first);
        throw InputError("", node_, fmt::format("no variable '{}' in data memory", name),
                         "a variable of the image" + did_you_mean(name, known));
    }
    return {debug::DebugChip::address_of_data(static_cast<std::uint16_t>(found->second.address)),
            found->second.bytes};
}

ChipValues::Place ChipValues::place_of(const json& request) const {
    Place place;
    if (request.contains("variable")) {
        place = variable(request.at("variable").get<std::string>());
    } else {
        const auto address = request.at("memory").get<std::uint32_t>();
        if (address >= kMostBytes)
            throw InputError("", node_, fmt::format("0x{:x} is no data address", address), "0 to 0xffff");
        place = {debug::DebugChip::address_of_data(static_cast<std::uint16_t>(address)), 0};
    }
    if (const auto bytes = request.value("bytes", std::uint32_t{0}); bytes > 0) place.bytes = bytes;
    constexpr std::uint32_t kWord = 2;
    if (place.bytes == 0) place.bytes = chip_.architecture().empty() ? kWord : 1;
    if (place.bytes > kMostBytes)
        throw InputError("", "bytes", fmt::format("{} are too many", place.bytes), "at most 65536");
    return place;
}

ordered_json ChipValues::read_register(std::string name) const {
    if (const auto core = debug::core_register(name, chip_))
        return {{"value", chip_.read_register(*core)},
                {"bits", chip_.registers()[*core].bits},
                {"fields", ordered_json::object()}};
    name = debug::upper_case(name);
    const auto special = chip_.special(name);
    if (!special) {
        const std::vector<std::string> names = chip_.special_names();
        throw InputError("", node_, fmt::format("the {} has no register '{}'", chip_.name(), name),
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

ordered_json ChipValues::read_field(const std::string& name, const std::string& field) const {
    ordered_json reply = read_register(name);
    const ordered_json fields = reply.at("fields");
    if (!fields.contains(field)) {
        std::vector<std::string> known;
        for (const auto& one : fields.items())
            known.push_back(one.key());
        throw InputError("", node_, fmt::format("{} has no field '{}'", name, field),
                         known.empty() ? "the whole register"
                                       : fmt::format("one of {}", fmt::join(known, ", ")));
    }
    reply["field"] = field;
    reply["value"] = fields.at(field);
    return reply;
}

ordered_json ChipValues::read(const json& request) const {
    if (request.contains("field"))
        return read_field(request.at("register").get<std::string>(), request.at("field").get<std::string>());
    if (request.contains("register")) return read_register(request.at("register").get<std::string>());
    const Place place = place_of(request);
    std::vector<std::uint8_t> bytes(place.bytes);
    if (!chip_.read_memory(place.address, bytes))
        throw InputError("", node_, "not all of these addresses exist", "addresses of data memory");
    ordered_json reply{
        {"address", place.address & (kMostBytes - 1)}, {"bytes", place.bytes}, {"data", hex_of(bytes)}};
    std::uint64_t value = 0;
    for (std::size_t i = std::min(bytes.size(), sizeof value); i > 0; --i)
        value = value << 8 | bytes[i - 1];
    if (bytes.size() <= sizeof value) reply["value"] = value;
    return reply;
}

void ChipValues::use_image(const std::string& file) {
    ImageNames names = names_in(file, is_avr(chip_));
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

}  // namespace puckloop::tools
