#pragma once
// Counts of what saves executing instructions one by one: how often each way was tried, and what it saved.
// They never go back to a mark, and nothing but a report of costs reads them.

#include <cstdint>

namespace puckloop::dspic {

struct FastWork {
    std::uint64_t loop_instructions = 0;     ///< passed in loops, not executed
    std::uint64_t service_instructions = 0;  ///< passed in service routines, not executed
    std::uint64_t services = 0;              ///< routines passed in one step, those within loops too
    std::uint64_t loop_walks = 0;            ///< loops analysed
    std::uint64_t loop_plans = 0;            ///< of these: with a plan, to be proven by a real iteration
    std::uint64_t loops_refused = 0;         ///< of these: never to be looked at again
    std::uint64_t loop_tables = 0;           ///< made (loop_table.h)
    std::uint64_t path_walks = 0;            ///< service routines analysed by what they read (isr_path.h)
    std::uint64_t paths = 0;                 ///< of these: with a path that can be taken
    std::uint64_t summary_walks = 0;         ///< service routines analysed for a summary (isr_summary.h)
};

}  // namespace puckloop::dspic
