// Who does the work of a grant: this thread, a helper or another process; and when its reply is taken.

#include "base/error.h"
#include "cosim/conductor_state.h"
#include "cosim/remote/node_hosts.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace puckloop::cosim {

namespace {
// Handing a piece of work over costs a good part of a microsecond, and one more look at the schedule.
constexpr double kWorthSharing = 3000.0;  // ns
// To wake a thread costs this one some 10 us where its core has gone to rest.
constexpr double kWorthWaking = 15000.0;  // ns
// The conductor works at least so many times as long as it planned while there is something to do.
constexpr int kWorkByPlanning = 4;
// How long to sleep where --realtime lets nobody go on.
constexpr std::chrono::microseconds kPaceSleep{500};
}  // namespace

/// Which of the nodes of this process just granted go to all threads: those that take long. What is short or
/// bound to this thread stays here.
void Conductor::State::share_out() {
    shared_.clear();
    std::size_t kept = 0;
    const bool available = workers_->available();
    for (const std::size_t n : here_) {
        if (available && specs_[n].any_thread && slots_[n].expected_ns() >= kWorthSharing)
            shared_.push_back(n);
        else
            here_[kept++] = n;
    }
    here_.resize(kept);
    // A short one alone is not worth waking a thread for.
    if (shared_.size() == 1 && workers_->awake() == 0 &&
        slots_[shared_.front()].expected_ns() < kWorthWaking) {
        here_.push_back(shared_.front());
        shared_.clear();
    }
    // What takes long goes first: it is the world, which all others wait for.
    std::stable_sort(shared_.begin(), shared_.end(), [this](std::size_t a, std::size_t b) {
        return slots_[a].expected_ns() > slots_[b].expected_ns();
    });
    for (const std::size_t n : shared_)
        workers_->submit(n, true);
}

/// One node's work on a grant, on any thread; false if it now waits for its program. `wait`: it may, for some
/// milliseconds.
bool Conductor::State::work(std::size_t n, bool wait) {
    // Only what may go to helpers is timed.
    const bool timed = specs_[n].any_thread && workers_->helpers() > 0;
    const WallClock::time_point begun = timed ? WallClock::now() : WallClock::time_point();
    bool done = true;
    try {
        done = handles_[n]->poll(wait);
    } catch (...) {
        failures_[n] = std::current_exception();
    }
    if (timed) slots_[n].worked(std::chrono::duration<double, std::nano>(WallClock::now() - begun).count());
    return done;
}

/// Lets nodes go on whose programs have got on, and appends those that are done to done_. `wait`: until one
/// has, for some milliseconds.
void Conductor::State::resume(bool wait) {
    std::size_t kept = 0;
    for (const std::size_t n : suspended_) {
        if (work(n, std::exchange(wait, false)))
            done_.push_back(n);
        else
            suspended_[kept++] = n;
    }
    suspended_.resize(kept);
}

/// Works or waits until a piece of work or a program is done, some milliseconds at most where it is a
/// program.
void Conductor::State::await_work() {
    if (workers_->do_one()) return;
    if (workers_->under_way() == 0) {
        // Others are not seen while one is waited for, which saves nothing where they answer at once.
        for (int looks = suspended_.size() > 1 ? kLooksAtSeveral : 0; looks > 0 && done_.empty(); --looks)
            resume(false);
        if (done_.empty()) resume(true);
        return;
    }
    workers_->wait([this] {
        if (!suspended_.empty()) resume(false);
        return !done_.empty();
    });
}

/// Lets the granted nodes of this process work, and takes what replies there are. False: none was granted.
bool Conductor::State::work_here() {
    share_out();
    done_.clear();
    const bool any = !here_.empty() || workers_->under_way() > 0 || !suspended_.empty();
    const bool granted = !here_.empty() || !shared_.empty();
    resume(false);
    for (const std::size_t n : here_) {
        current_ = n;
        if (work(n, false))
            take_local_reply(n);
        else
            suspended_.push_back(n);
    }
    // Where a look at the whole run takes long, as with many nodes, some work is done between two.
    const WallClock::duration least = kWorkByPlanning * (planned_at_ - plan_begun_);
    while (workers_->waiting() > workers_->helpers() && WallClock::now() - planned_at_ < least)
        workers_->do_one();
    take_done();
    // Beside what has just been handed out others may be able to go on: that is seen first.
    if (done_.empty() && !granted && any) {
        await_work();
        take_done();
    }
    here_.clear();
    for (const std::size_t n : done_)
        take_local_reply(n);
    return any;
}

/// Appends the nodes that helpers are done with to done_.
void Conductor::State::take_done() {
    workers_->take_done(done_);
    if (std::erase(done_, trace_piece()) > 0) take_written();
}

void Conductor::State::take_local_reply(std::size_t n) {
    current_ = n;
    if (failures_[n]) std::rethrow_exception(failures_[n]);
    take_reply(n);
}

void Conductor::State::collect() {
    elsewhere_.clear();
    if (elsewhere_too_)
        for (std::size_t n = 0; n < handles_.size(); ++n)
            if (times_[n].busy && handles_[n]->elsewhere()) elsewhere_.push_back(n);
    const bool any = work_here();
    if (!elsewhere_.empty()) {
        collect_elsewhere(!any);
    } else if (!any) {
        // Nobody works and nobody may be granted: ahead of the wall clock, or locked for good.
        if (!options_.realtime || stuck()) deadlock();
        std::this_thread::sleep_for(kPaceSleep);
    }
}

/// Takes what nodes of other processes have answered; with `wait` until there is something.
void Conductor::State::collect_elsewhere(bool wait) {
    for (int looks = wait ? 2 : 1; looks > 0; --looks) {
        const std::uint32_t seen = processes_ ? processes_->rings() : 0;
        bool any = false;
        for (const std::size_t n : elsewhere_) {
            current_ = n;
            if (!handles_[n]->poll(false)) continue;
            take_reply(n);
            any = true;
        }
        if (any) return;
        if (looks == 2)
            processes_ ? processes_->await_answers(seen, elsewhere_.size()) : options_.hosts->await_answers();
    }
}

}  // namespace puckloop::cosim
