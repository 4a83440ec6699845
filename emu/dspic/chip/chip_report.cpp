// What is reported of a dsPIC: what its program waits for, and what came about.

#include "emu/dspic/chip/chip_parts.h"
#include "emu/dspic/fast/fast_work.h"
#include "emu/dspic/judge/judge.h"
#include "emu/dspic/waits/status_bits.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {
constexpr double kShortestWait = 0.1;  // s
}

std::optional<WaitReport> Chip::waiting() const {
    const Parts& parts = *parts_;
    const WaitContext context{parts.device, parts.layout, parts.sfr, parts.interrupts,
                              parts.core,   parts.ports,  parts.pins};
    WaitReport report;
    if (parts.asleep_since) {
        report.asleep = true;
        report.hung = sleeps_for_ever(context);
        report.since = *parts.asleep_since;
        report.text = report.hung ? "and no interrupt can wake it" : "until an interrupt comes";
    } else if (const std::optional<Core::BusyLoop> loop = parts.core.busy_loop()) {
        report = judge(context, loop->finding, loop->level);
        report.since = loop->since;
    } else {
        return std::nullopt;
    }
    if (static_cast<double>(parts.core.cycle() - report.since) < kShortestWait * parts.clock.hertz())
        return std::nullopt;
    return report;
}

ChipReport Chip::report() const {
    ChipReport report = parts_->report;
    for (const MissingPoll& poll : parts_->core.missing_polls())
        report.missing_bits.push_back(
            {poll.cycle, poll.first, poll.last,
             register_text(*parts_->sfr.info(poll.condition.address), poll.condition.mask)});
    for (const I2cMaster& master : parts_->masters)
        for (const auto& [address, times] : master.refused())
            report.refused_addresses.push_back({master.unit(), address, times});
    report.instructions = parts_->core.instructions();
    report.cycles = parts_->core.cycle();
    return report;
}

void Chip::add_work(cosim::WorkCounts& counts) const {
    const FastWork& work = parts_->core.fast_work();
    const std::uint64_t all = parts_->instructions_run;
    const std::uint64_t passed = work.loop_instructions + work.service_instructions;
    counts.insert(counts.end(), {{"instructions in all", all},
                                 {"instructions executed", all - std::min(all, passed)},
                                 {"instructions passed in loops", work.loop_instructions},
                                 {"instructions passed in routines", work.service_instructions},
                                 {"routines passed", work.services},
                                 {"loops analysed", work.loop_walks},
                                 {"loops analysed with success", work.loop_plans},
                                 {"loops refused for good", work.loops_refused},
                                 {"loop tables", work.loop_tables},
                                 {"routines analysed for a path", work.path_walks},
                                 {"routines analysed with success", work.paths},
                                 {"routines analysed for a summary", work.summary_walks}});
}

}  // namespace puckloop::dspic
