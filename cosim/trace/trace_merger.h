#pragma once
// Puts the trace in its one order: holds messages back until nothing earlier can come.

#include "cosim/trace/trace.h"

#include <cstddef>
#include <vector>

namespace puckloop::cosim {

class TraceMerger {
  public:
    void add(const TraceRecord& record) { waiting_.push_back(record); }
    std::size_t waiting() const { return waiting_.size(); }
    /// What was not taken yet, in no order.
    const std::vector<TraceRecord>& records() const { return waiting_; }
    /// Is a release worth its while? What had to wait then is not gone through again before as much has come.
    bool full() const { return waiting_.size() >= enough_; }

    /// Moves everything before `floor` to `batch`, in place of what that held and in no order.
    void take(Time floor, std::vector<TraceRecord>& batch);
    /// The order of the trace.
    static void sort(std::vector<TraceRecord>& batch);

  private:
    static constexpr std::size_t kBatch = 512;
    std::vector<TraceRecord> waiting_;
    std::size_t enough_ = kBatch;
};

}  // namespace puckloop::cosim
