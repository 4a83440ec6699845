#include "cosim/trace/trace_merger.h"

#include <algorithm>

namespace puckloop::cosim {

void TraceMerger::take(Time floor, std::vector<TraceRecord>& batch) {
    const auto due = std::partition(waiting_.begin(), waiting_.end(),
                                    [floor](const TraceRecord& record) { return record.time < floor; });
    batch.assign(waiting_.begin(), due);
    waiting_.erase(waiting_.begin(), due);
    enough_ = std::max(kBatch, 2 * waiting_.size());
}

void TraceMerger::sort(std::vector<TraceRecord>& batch) {
    std::sort(batch.begin(), batch.end(),
              [](const TraceRecord& a, const TraceRecord& b) { return a.key() < b.key(); });
}

}  // namespace puckloop::cosim
