#include "cosim/trace/trace_merger.h"

#include <algorithm>

namespace puckloop::cosim {

void TraceMerger::order(Time floor) {
    const auto due = std::partition(waiting_.begin(), waiting_.end(),
                                    [floor](const TraceRecord& record) { return record.time < floor; });
    std::sort(waiting_.begin(), due,
              [](const TraceRecord& a, const TraceRecord& b) { return a.key() < b.key(); });
    ready_ = static_cast<std::size_t>(due - waiting_.begin());
}

}  // namespace puckloop::cosim
