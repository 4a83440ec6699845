#pragma once
// The events of a folder that grows: read again and again, each time from its begin, at times that leave the
// processor to the run.

#include "view/events/read_events.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace puckloop::view {

class EventPasses {
  public:
    /// Asked by another thread.
    struct Run {
        std::function<bool()> goes_on;         ///< the folder still grows
        std::function<std::uint64_t()> epoch;  ///< rises when it was cut back: it is read again at once
        std::function<bool()> stands;  ///< just now it does not grow, and reading costs nobody anything
    };
    /// Reads while somebody looks on, that is has asked for latest() within `looks_on` seconds. `recording`
    /// must outlive it.
    EventPasses(const Recording& recording, Run run, double looks_on = 5.0);
    ~EventPasses();
    EventPasses(const EventPasses&) = delete;
    EventPasses& operator=(const EventPasses&) = delete;

    /// How many passes there were.
    std::uint32_t passes() const { return passes_; }
    /// The latest that is whole; the first one from its begin.
    std::shared_ptr<const EventReader> latest() const;

  private:
    void run();
    bool watched() const;
    std::uintmax_t trace_bytes() const;

    const Recording& recording_;
    Run run_;
    double looks_on_;
    mutable std::atomic<std::int64_t> asked_ms_ = 0;  ///< latest() was called, of a steady clock
    std::atomic<bool> stop_ = false;
    std::atomic<std::uint32_t> passes_ = 1;
    mutable std::mutex mutex_;
    std::shared_ptr<const EventReader> latest_;
    std::thread thread_;
};

}  // namespace puckloop::view
