#pragma once
// The events of a folder that grows: read again and again, each time from its begin, at times that leave the
// processor to the run.

#include "view/read_events.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace puckloop::view {

class EventPasses {
  public:
    /// `goes_on`: the folder still grows. `epoch` rises when it was cut back: what is read then is given up,
    /// and read again. Both are asked by another thread. `recording` must outlive it.
    EventPasses(const Recording& recording, std::function<bool()> goes_on,
                std::function<std::uint64_t()> epoch);
    ~EventPasses();
    EventPasses(const EventPasses&) = delete;
    EventPasses& operator=(const EventPasses&) = delete;

    /// The latest that is whole; the first one from its begin.
    std::shared_ptr<const EventReader> latest() const;

  private:
    void run();

    const Recording& recording_;
    std::function<bool()> goes_on_;
    std::function<std::uint64_t()> epoch_;
    std::atomic<bool> stop_ = false;
    mutable std::mutex mutex_;
    std::shared_ptr<const EventReader> latest_;
    std::thread thread_;
};

}  // namespace puckloop::view
