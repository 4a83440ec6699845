#include "cosim/schedule/workers.h"

#include "cosim/core/cores.h"
#include "cosim/core/process_name.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <string>
#include <utility>

namespace puckloop::cosim {

namespace {

// Looks before a helper sleeps; some 60 us: to wake it costs the caller 10 us where its core has gone to
// rest, and it begins 20 to 40 us later. Soon it gives way to whoever else is ready, such as a program of the
// run.
constexpr int kLooksBeforeSleep = 2000;
constexpr int kLooksBeforeYield = 200;
constexpr int kLooksBetweenYields = 32;
constexpr auto kPutAside = std::chrono::microseconds(500);
constexpr int kTurnsAlone = 400;

}  // namespace

// The rings' sizes are powers of two, so that counters may wrap around.
Workers::Workers(unsigned helpers, std::size_t pieces, Work work)
    : work_(std::move(work)), pieces_(std::bit_ceil(pieces + 1)), done_(std::bit_ceil(pieces + 1)) {
    for (unsigned i = 0; i < helpers; ++i)
        threads_.emplace_back([this, i, &asleep = asleep_.emplace_back(0)] {
            name_thread("worker " + std::to_string(i + 1));
            help(asleep);
        });
}

Workers::~Workers() {
    ending_.store(true);
    for (std::atomic<int>& asleep : asleep_) {
        asleep.store(0);
        asleep.notify_one();
    }
    for (std::thread& thread : threads_)
        thread.join();
}

void Workers::submit(std::size_t piece, bool wake) {
    const std::uint32_t place = handed_out_.load(std::memory_order_relaxed);
    pieces_[place % pieces_.size()].store(piece, std::memory_order_relaxed);
    ++under_way_;
    handed_out_.store(place + 1);
    if (wake) wake_one();
}

/// One that sleeps, and has not been called yet.
void Workers::wake_one() {
    for (std::atomic<int>& asleep : asleep_) {
        if (asleep.load() == 0 || asleep.exchange(0) == 0) continue;
        asleep.notify_one();
        return;
    }
}

unsigned Workers::awake() const {
    return static_cast<unsigned>(
        std::count_if(asleep_.begin(), asleep_.end(), [](const std::atomic<int>& asleep) {
            return asleep.load(std::memory_order_relaxed) == 0;
        }));
}

bool Workers::has_work() const {
    return begun_.load() != handed_out_.load();
}

bool Workers::do_one() {
    std::uint32_t place = begun_.load(std::memory_order_acquire);
    while (place != handed_out_.load(std::memory_order_acquire)) {
        const std::size_t piece = pieces_[place % pieces_.size()].load(std::memory_order_relaxed);
        if (!begun_.compare_exchange_weak(place, place + 1, std::memory_order_acq_rel)) continue;
        work_(piece);
        const std::uint32_t end = finished_.fetch_add(1, std::memory_order_relaxed);
        done_[end % done_.size()].store(piece + 1, std::memory_order_release);
        return true;
    }
    return false;
}

bool Workers::is_done() const {
    return done_[taken_ % done_.size()].load(std::memory_order_acquire) != 0;
}

void Workers::take_done(std::vector<std::size_t>& done) {
    while (true) {
        std::atomic<std::size_t>& next = done_[taken_ % done_.size()];
        const std::size_t piece = next.load(std::memory_order_acquire);
        if (piece == 0) return;
        next.store(0, std::memory_order_relaxed);
        ++taken_;
        --under_way_;
        done.push_back(piece - 1);
    }
}

void Workers::help(std::atomic<int>& asleep) {
    int looks = 0;
    while (!ending_.load(std::memory_order_acquire)) {
        if (do_one()) {
            looks = 0;
        } else if (++looks < kLooksBeforeSleep) {
            relax_core();
            if (looks > kLooksBeforeYield && looks % kLooksBetweenYields == 0) std::this_thread::yield();
        } else {
            asleep.store(1);
            if (!has_work() && !ending_.load()) asleep.wait(1);
            asleep.store(0);
            looks = 0;
        }
    }
}

void Workers::wait(const std::function<bool()>& other) {
    using Clock = std::chrono::steady_clock;
    Clock::time_point begun{};
    for (int looks = 0; !is_done() && !other(); ++looks) {
        if (looks < kLooksBeforeYield) {
            relax_core();
            continue;
        }
        if (looks == kLooksBeforeYield) begun = Clock::now();
        std::this_thread::yield();
        if (Clock::now() - begun > kPutAside) alone_ = kTurnsAlone;
    }
}

void Workers::stop() {
    std::vector<std::size_t> done;
    // Nobody begins another one; those begun come to their end.
    std::uint32_t place = begun_.load();
    while (!begun_.compare_exchange_weak(place, handed_out_.load())) {
    }
    const std::uint32_t left = handed_out_.load() - place;
    under_way_ -= left;
    while (under_way_ > 0) {
        wait();
        take_done(done);
    }
}

}  // namespace puckloop::cosim
