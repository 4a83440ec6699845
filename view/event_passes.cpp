#include "view/event_passes.h"

#include <algorithm>
#include <chrono>

namespace puckloop::view {

namespace {

constexpr double kPause = 1.0;  // s between passes, at least
constexpr double kIdle = 3.0;   // times as long as a pass took
constexpr auto kLook = std::chrono::milliseconds(20);

}  // namespace

EventPasses::EventPasses(const Recording& recording, std::function<bool()> goes_on,
                         std::function<std::uint64_t()> epoch)
    : recording_(recording),
      goes_on_(std::move(goes_on)),
      epoch_(std::move(epoch)),
      latest_(std::make_shared<EventReader>(recording, EventTable::kMost, 0)),
      thread_([this] { run(); }) {}

EventPasses::~EventPasses() {
    stop_ = true;
    thread_.join();
}

std::shared_ptr<const EventReader> EventPasses::latest() const {
    const std::lock_guard lock(mutex_);
    return latest_;
}

void EventPasses::run() {
    using Clock = std::chrono::steady_clock;
    constexpr std::uint32_t kGenerations = 1U << 16;  // more than one pass thins
    std::shared_ptr<const EventReader> reader = latest();
    bool last = false;
    std::uint64_t epoch = 0;  // what an earlier one's reader reads is cut off under it
    const auto goes_back = [&] { return epoch_() != epoch; };
    for (std::uint32_t pass = 1; !stop_; ++pass) {
        const auto begun = Clock::now();
        while (!reader->done() && !stop_ && !goes_back())
            std::this_thread::sleep_for(kLook);
        if (!goes_back()) {
            const std::lock_guard lock(mutex_);
            latest_ = reader;
        }
        if (last && !goes_back()) return;
        const std::chrono::duration<double> took = Clock::now() - begun;
        const double pause = std::max(kPause, kIdle * took.count());
        const auto again = Clock::now();
        while (!stop_ && goes_on_() && !goes_back() &&
               std::chrono::duration<double>(Clock::now() - again).count() < pause)
            std::this_thread::sleep_for(kLook);
        if (stop_) return;
        last = !goes_on_();
        epoch = epoch_();
        reader = std::make_shared<EventReader>(recording_, EventTable::kMost, pass * kGenerations);
    }
}

}  // namespace puckloop::view
