// Addresses and times in the node's description, and its report.

#include "base/error.h"
#include "base/fields/json.h"
#include "base/json.h"
#include "emu/bluetooth/air_node.h"

#include <fmt/format.h>

#include <charconv>

namespace puckloop::bluetooth {

using nlohmann::json;

namespace {

json to_json(const Module& module) {
    const ModuleCounts& counts = module.counts();
    return {{"address", protocols::lmx_address_text(module.settings().address)},
            {"name", module.settings().name},
            {"bytes_in", counts.bytes_in},
            {"bytes_out", module.serial().sent()},
            {"while_down", counts.while_down},
            {"framing_errors", counts.framing_errors},
            {"between_packets", counts.between_packets},
            {"bad_packets", counts.bad_packets},
            {"requests", counts.requests},
            {"errors", counts.errors},
            {"not_modelled", counts.not_modelled},
            {"transparent_in", counts.transparent_in},
            {"transparent_out", counts.transparent_out},
            {"resets", counts.resets}};
}

}  // namespace

Address parse_address(std::string_view place, std::string_view text) {
    Address address{};
    const auto refuse = [&] {
        throw InputError("", place, fmt::format("'{}' is no Bluetooth address", text),
                         "six octets: \"08:00:17:2C:00:01\"");
    };
    constexpr std::size_t kText = 17;
    if (text.size() != kText) refuse();
    for (std::size_t i = 0; i < address.size(); ++i) {
        const char* first = text.data() + 3 * i;
        unsigned octet = 0;
        const auto [end, error] = std::from_chars(first, first + 2, octet, 16);
        if (error != std::errc() || end != first + 2 || (i > 0 && first[-1] != ':')) refuse();
        address[address.size() - 1 - i] = static_cast<std::uint8_t>(octet);
    }
    return address;
}

JsonValue AddressForm::write(const Address& address) {
    return protocols::lmx_address_text(address);
}

void AddressForm::read(Address& address, const JsonValue& from, const std::string& place) {
    std::string text;
    from_value(text, from, place);
    address = parse_address(place, text);
}

JsonValue SpreadForm::write(const Spread& spread) {
    return to_value(std::array{spread.mean, spread.sd});
}

void SpreadForm::read(Spread& spread, const JsonValue& from, const std::string& place) {
    std::array<double, 2> both{};
    from_value(both, from, place);
    spread = {both[0], both[1]};
}

std::string AirNode::finish() {
    json modules = json::object();
    std::vector<std::string> warnings;
    for (const auto& module : modules_) {
        modules[std::string(module->name())] = to_json(*module);
        for (const auto& [request, times] : module->counts().not_modelled)
            warnings.push_back(
                fmt::format("{}: the Bluetooth module does not model {}", module->name(), request));
    }
    const NetworkCounts& counts = network_.counts();
    if (log_ != nullptr) std::fflush(log_);
    return json{{"inquiries", counts.inquiries},
                {"found", counts.found},
                {"not_found_in_time", counts.missed},
                {"names", counts.names},
                {"names_missing", counts.names_missing},
                {"attempts", counts.attempts},
                {"links", counts.links},
                {"nobody", counts.not_found},
                {"refused", counts.refused},
                {"lost", counts.lost},
                {"bytes", counts.bytes},
                {"bytes_lost", counts.bytes_lost},
                {"modules", std::move(modules)},
                {"warnings", warnings}}
        .dump();
}

}  // namespace puckloop::bluetooth
