// A profile for programs: "stats" of `exec --json` and of a node in report.json.

#include "base/json.h"
#include "debug/profile/profile.h"

#include <fmt/format.h>

namespace puckloop::debug {

namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMostReadsInJson = 1000;

ordered_json functions_json(const Profile& profile, const Places& places) {
    const FunctionNames names(profile, places);
    ordered_json functions = ordered_json::array();
    for (const auto& [start, cost] : function_costs(profile, names))
        functions.push_back({{"name", names.name_of(start)},
                             {"address", fmt::format("0x{:06x}", start)},
                             {"cycles", cost.cycles},
                             {"instructions", cost.instructions}});
    return functions;
}

ordered_json reads_json(const Profile& profile, const Places& places, const Variables& variables) {
    ordered_json reads = ordered_json::array();
    for (const Profile::Unwritten& read : profile.unwritten()) {
        if (reads.size() == kMostReadsInJson) break;
        reads.push_back({{"address", read.address},
                         {"variable", variables.name_at(read.address)},
                         {"pc", fmt::format("0x{:06x}", read.pc)},
                         {"place", places.place(read.pc)},
                         {"line", places.lines().at(read.pc)},
                         {"cycle", read.cycle},
                         {"times", read.times}});
    }
    return reads;
}

}  // namespace

std::string profile_json(const Profile& profile, const Places& places, const Variables& variables,
                         const DebugChip& chip) {
    ordered_json json{{"functions", functions_json(profile, places)}};
    if (const auto& stack = profile.stack())
        json["stack"] = {{"bytes", stack->bytes()},
                         {"base", stack->base},
                         {"peak", stack->peak},
                         {"pc", fmt::format("0x{:06x}", stack->peak_pc)},
                         {"place", places.place(stack->peak_pc)},
                         {"line", places.lines().at(stack->peak_pc)}};
    if (const auto use = stack_use(profile, variables, chip)) {
        if (use->left) json["stack"]["left"] = *use->left;
        json["stack"]["over_variables"] = use->over.bytes;
        json["stack"]["variables"] = use->over.names;
    }
    json["unwritten_reads"] = profile.unwritten_reads();
    json["unwritten"] = reads_json(profile, places, variables);
    return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace puckloop::debug
