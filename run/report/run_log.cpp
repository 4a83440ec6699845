#include "run/report/run_log.h"

#include "base/logs/log.h"

#include <algorithm>

namespace puckloop::tools {

RunLog::RunLog(const RunSetup& setup, const RunRequest& request) : setup_(setup) {
    log::info("scenario {}: {} nodes, {} links, {} faults, seed {}, {}", request.scenario.string(),
              setup.nodes.size(), setup.links.size(), setup.scenario.faults.size(), setup.scenario.seed,
              setup.scenario.duration ? fmt::format("{} s", *setup.scenario.duration) : "without end");
    log::info("results in {}", setup.out.string());
    if (!setup.cache_unused.empty()) log::info("{}", setup.cache_unused);
    for (const auto& link : setup.links)
        log::info("link {}: {}.{} - {}.{}{}", link.name, link.a.node, link.a.port, link.b.node, link.b.port,
                  link.nominal_baud > 0.0 ? fmt::format(", {} baud", link.nominal_baud) : std::string());
}

double RunLog::phase_seconds() {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - phase_).count();
    phase_ = now;
    return seconds;
}

void RunLog::started(const cosim::Conductor& conductor) {
    for (const auto& node : setup_.nodes) {
        const int process = conductor.process_of(node.name);
        log::info("node {}: {}", node.name,
                  process > 0 ? fmt::format("process {}", process) : "in this process");
    }
    log::info("nodes started in {:.2f} s", phase_seconds());
}

void RunLog::progress(const cosim::Progress& now) {
    if (now.wall_s - said_wall_s_ < 1.0) return;
    said_wall_s_ = now.wall_s;
    log::debug("{:.3f} s simulated, {:.1f} x real time", cosim::to_seconds(now.time), now.factor);
}

void RunLog::ended(const cosim::Outcome& outcome) {
    const double seconds = phase_seconds();
    log::info("run ended{}: {}", outcome.success ? "" : " without success", outcome.text);
    log::info("{:.3f} s simulated in {:.2f} s, {} grants ({:.0f} a second)",
              cosim::to_seconds(outcome.simulated), seconds, outcome.grants,
              static_cast<double>(outcome.grants) / std::max(seconds, 1e-6));
    for (const auto& node : outcome.nodes)
        log::debug("node {}: {} grants", node.name, node.grants);
    for (const auto& link : outcome.links)
        log::debug("link {}: {} messages from {}, {} from {}", link.name, link.from_a.messages, link.a,
                   link.from_b.messages, link.b);
    for (const auto& warning : outcome.warnings)
        log::warning("{}", warning);
}

void RunLog::written() {
    log::info("picture and report written in {:.2f} s", phase_seconds());
}

}  // namespace puckloop::tools
