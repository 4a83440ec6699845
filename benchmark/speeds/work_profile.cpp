#include "benchmark/speeds/work_profile.h"

#include "base/error.h"
#include "cosim/interrupt.h"
#include "run/run_scenario.h"

#include <algorithm>

namespace puckloop::tools {

namespace {

std::string kind_of(const std::string& name) {
    return name.substr(name.rfind('.') + 1);
}

/// Of a link: "epuck1.i2c.rab" is of the kind "i2c.rab".
std::string link_kind(const std::string& name) {
    return name.substr(name.find('.') + 1);
}

void add(KindWork& work, const std::string& name, double count) {
    const auto same = [&](const auto& one) { return one.first == name; };
    const auto at = std::find_if(work.counts.begin(), work.counts.end(), same);
    if (at == work.counts.end())
        work.counts.emplace_back(name, count);
    else
        at->second += count;
}

}  // namespace

double KindWork::count(const std::string& name) const {
    for (const auto& [known, value] : counts)
        if (known == name) return value;
    return 0;
}

const KindWork* WorkProfile::kind(const std::string& name) const {
    for (const KindWork& work : kinds)
        if (work.kind == name) return &work;
    return nullptr;
}

double WorkProfile::instructions_needed() const {
    constexpr double kMicroseconds = 1e6;
    double needed = 0;
    for (const KindWork& work : kinds) {
        const double executed_us = work.count("us executed");
        if (executed_us <= 0) continue;
        const double once = kMicroseconds * simulated_s * static_cast<double>(work.nodes) / executed_us;
        needed += work.count("instructions executed") * std::min(1.0, once);
    }
    return needed;
}

WorkProfile profile_work(const RunRequest& request) {
    const RunSetup setup = set_up(request);
    const cosim::InterruptGuard interrupt;
    const cosim::Outcome outcome = run_scenario(setup, request, {}, &interrupt);
    if (!outcome.success || outcome.reason == cosim::EndReason::Interrupted) throw RunError(outcome.text);
    WorkProfile profile{cosim::to_seconds(outcome.simulated), {}, {}};
    for (const auto& node : outcome.nodes) {
        const std::string kind = kind_of(node.name);
        auto at = std::find_if(profile.kinds.begin(), profile.kinds.end(),
                               [&](const KindWork& work) { return work.kind == kind; });
        if (at == profile.kinds.end()) at = profile.kinds.insert(at, {kind, 0, {}});
        ++at->nodes;
        add(*at, "grants", static_cast<double>(node.grants));
        for (const auto& [name, count] : node.work)
            add(*at, name, static_cast<double>(count));
    }
    for (const auto& link : outcome.links)
        profile.messages[link_kind(link.name)] +=
            static_cast<double>(link.from_a.messages + link.from_b.messages);
    return profile;
}

}  // namespace puckloop::tools
