#include "cosim/faults/spec/fault_spec.h"

#include "base/error.h"

#include <fmt/format.h>

#include <set>

namespace puckloop::cosim {

double FaultParameters::number(std::string_view key, double fallback) const {
    const auto found = numbers.find(key);
    return found == numbers.end() ? fallback : found->second;
}

Time FaultParameters::time(std::string_view key, Time fallback) const {
    const auto found = numbers.find(key);
    return found == numbers.end() ? fallback : from_seconds(found->second);
}

std::string FaultParameters::text(std::string_view key, std::string_view fallback) const {
    const auto found = texts.find(key);
    return found == texts.end() ? std::string(fallback) : found->second;
}

std::string describe(const FaultSpec& spec) {
    return fmt::format("{} on {}{}{}", spec.kind, spec.link.empty() ? spec.node : spec.link,
                       spec.from.empty() ? "" : " from ", spec.from);
}

void name_faults(std::vector<FaultSpec>& faults) {
    std::set<std::string> names;
    for (const FaultSpec& fault : faults)
        if (!fault.name.empty() && !names.insert(fault.name).second)
            throw InputError("", fmt::format("fault {}", fault.name), "two faults have this name");
    for (FaultSpec& fault : faults) {
        if (!fault.name.empty()) continue;
        const std::string base =
            fmt::format("{}.{}", fault.link.empty() ? fault.node : fault.link, fault.kind);
        fault.name = base;
        for (int number = 2; !names.insert(fault.name).second; ++number)
            fault.name = fmt::format("{}.{}", base, number);
    }
}

}  // namespace puckloop::cosim
