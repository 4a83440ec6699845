#include "view/events/event_passes.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <utility>

namespace puckloop::view {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kPause = 1.0;  // s between passes, at least
constexpr double kShort = 0.2;  // s, of a run that stands
constexpr double kIdle = 12.0;  // times as long as a pass took: reading takes a thirteenth of the time
constexpr auto kLook = std::chrono::milliseconds(20);

double seconds_from(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::int64_t now_ms() {
    return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now().time_since_epoch()).count();
}

}  // namespace

EventPasses::EventPasses(const Recording& recording, Run run, double looks_on)
    : recording_(recording),
      run_(std::move(run)),
      looks_on_(looks_on),
      asked_ms_(now_ms()),
      latest_(std::make_shared<EventReader>(recording, EventTable::kMost, 0)),
      thread_([this] { this->run(); }) {}

EventPasses::~EventPasses() {
    stop_ = true;
    thread_.join();
}

std::shared_ptr<const EventReader> EventPasses::latest() const {
    asked_ms_ = now_ms();
    const std::lock_guard lock(mutex_);
    return latest_;
}

bool EventPasses::watched() const {
    return static_cast<double>(now_ms() - asked_ms_) < 1e3 * looks_on_;
}

std::uintmax_t EventPasses::trace_bytes() const {
    std::error_code none;
    const auto bytes = std::filesystem::file_size(recording_.folder() / "trace.csv", none);
    return none ? 0 : bytes;
}

void EventPasses::run() {
    constexpr std::uint32_t kGenerations = 1U << 16;  // more than one pass thins
    std::shared_ptr<const EventReader> reader;
    {
        const std::lock_guard lock(mutex_);
        reader = latest_;
    }
    bool last = false;
    std::uint64_t epoch = 0;  // what an earlier one's reader reads is cut off under it
    std::uintmax_t read = 0;
    const auto goes_back = [&] { return run_.epoch() != epoch; };
    for (std::uint32_t pass = 1; !stop_; ++pass) {
        const auto begun = Clock::now();
        while (!reader->done() && !stop_ && !goes_back())
            std::this_thread::sleep_for(kLook);
        if (!goes_back()) {
            const std::lock_guard lock(mutex_);
            latest_ = reader;
        }
        if (last && !goes_back()) return;
        const double pause = std::max(kPause, kIdle * seconds_from(begun));
        const auto again = Clock::now();
        // What is there is known, nobody looks on, or reading would slow the run down.
        const auto is_due = [&] {
            return watched() && seconds_from(again) >= (run_.stands() ? kShort : pause) &&
                   trace_bytes() != read;
        };
        while (!stop_ && run_.goes_on() && !goes_back() && !is_due())
            std::this_thread::sleep_for(kLook);
        if (stop_) return;
        last = !run_.goes_on();
        epoch = run_.epoch();
        read = trace_bytes();
        reader = std::make_shared<EventReader>(recording_, EventTable::kMost, pass * kGenerations);
        ++passes_;
    }
}

}  // namespace puckloop::view
