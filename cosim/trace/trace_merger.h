#pragma once
// Puts the trace in its one order: holds messages back until nothing earlier can come.

#include "cosim/trace/trace.h"

#include <algorithm>
#include <vector>

namespace puckloop::cosim {

class TraceMerger {
  public:
    void add(const TraceRecord& record) { waiting_.push_back(record); }
    std::size_t waiting() const { return waiting_.size(); }
    /// Is a release worth its while? What had to wait then is not gone through again before as much has come.
    bool full() const { return waiting_.size() >= enough_; }

    /// Hands everything before `floor` to `sink`, in order, and forgets it.
    template <typename Sink>
    void release(Time floor, Sink sink) {
        order(floor);
        for (std::size_t i = 0; i < ready_; ++i)
            sink(waiting_[i]);
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(ready_));
        enough_ = std::max(kBatch, 2 * waiting_.size());
    }

  private:
    void order(Time floor);

    static constexpr std::size_t kBatch = 512;
    std::vector<TraceRecord> waiting_;
    std::size_t enough_ = kBatch;
    std::size_t ready_ = 0;
};

}  // namespace puckloop::cosim
