#include "base/json.h"
#include "emu/xbee/module_node.h"

#include <fmt/format.h>

namespace puckloop::xbee {

namespace {

using nlohmann::json;

/// Counters by the names of what they count, those that are zero left out.
template <class Fault, std::size_t count>
json by_name(const std::array<std::uint64_t, count>& counters) {
    json result = json::object();
    for (std::size_t i = 0; i < count; ++i)
        if (counters[i] != 0) result[std::string(name_of(static_cast<Fault>(i)))] = counters[i];
    return result;
}

json fates(const ModuleCounts& counts) {
    json result = json::object();
    for (const auto& [status, count] : counts.fates)
        result[fmt::format("{:02X}", status)] = count;
    return result;
}

}  // namespace

std::string to_json(const Module& module) {
    const ModuleCounts& n = module.counts();
    json report{{"address", fmt::format("{:016X}", module.options().address)},
                {"node_identifier", module.settings().node_identifier()},
                {"channel", module.settings()[kCH]},
                {"pan", fmt::format("{:04X}", module.settings()[kID])},
                {"resets", n.resets},
                {"sleeps", n.sleeps},
                {"uart",
                 {{"bytes_in", n.bytes_in},
                  {"bytes_out", module.serial().sent()},
                  {"framing_errors", n.framing_errors},
                  {"overflow", n.overflow},
                  {"while_down", n.while_down},
                  {"while_asleep", n.while_asleep},
                  {"frames_in", n.frames_in},
                  {"frames_out", n.frames_out},
                  {"bad_frames", by_name<protocols::XBeeFault>(n.bad_frames)},
                  {"between_frames", n.between_frames},
                  {"unknown_frames", n.odd_frames},
                  {"dropped_out", n.dropped_out}}},
                {"at",
                 {{"commands", n.at_commands},
                  {"bad_values", n.bad_values},
                  {"unknown", n.unknown_at},
                  {"command_modes", n.command_modes},
                  {"without_effect", n.without_effect}}},
                {"air",
                 {{"sent", n.sent},
                  {"too_long", n.too_long},
                  {"delivery_status", fates(n)},
                  {"retries", n.retries},
                  {"received", n.received},
                  {"discoveries", n.discoveries},
                  {"answered_discoveries", n.shown},
                  {"bad_frames", by_name<protocols::MeshFault>(n.bad_air)},
                  {"of_others", n.not_for_us}}}};
    const std::uint64_t useless = n.between_frames + n.framing_errors;
    if (n.frames_in == 0 && useless != 0)
        report["warnings"] = {
            fmt::format("{} bytes came and no API frame (expected the rate of BD = {}, frames of AP = {})",
                        useless, module.settings()[kBD], module.settings()[kAP])};
    return report.dump();
}

}  // namespace puckloop::xbee
