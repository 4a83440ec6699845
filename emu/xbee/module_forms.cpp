// How a module's address and parameters are written in descriptions.

#include "base/error.h"
#include "base/fields/json.h"
#include "emu/xbee/module.h"

#include <fmt/format.h>

#include <charconv>

namespace puckloop::xbee {

JsonValue HexAddress::write(std::uint64_t address) {
    return fmt::format("{:016X}", address);
}

void HexAddress::read(std::uint64_t& address, const JsonValue& from, const std::string& place) {
    std::string text;
    from_value(text, from, place);
    constexpr int kHex = 16;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), address, kHex);
    if (error != std::errc() || end != text.data() + text.size())
        throw InputError("", place, "bad address", "16 hex digits");
}

JsonValue FlashParameters::write(const List& parameters) {
    JsonValue object = JsonValue::Object{};
    for (const auto& [command, value] : parameters)
        object.set(command, value);
    return object;
}

void FlashParameters::read(List& parameters, const JsonValue& from, const std::string& place) {
    std::map<std::string, std::uint32_t> values;
    from_value(values, from, place);
    parameters.assign(values.begin(), values.end());
}

}  // namespace puckloop::xbee
