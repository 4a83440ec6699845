#include "cosim/schedule/workers.h"

#include "cosim/core/process_name.h"

#include <chrono>
#include <string>

namespace puckloop::cosim {

namespace {

constexpr unsigned kNextBits = 16, kCountBits = 16;
constexpr std::uint64_t kNextMask = (std::uint64_t{1} << kNextBits) - 1;
constexpr std::uint64_t kCountMask = (std::uint64_t{1} << kCountBits) - 1;
// Looks before a helper sleeps; some 20 us, about what it takes to wake it.
constexpr int kLooks = 600;
constexpr int kLooksBeforeYield = 200;
constexpr auto kPutAside = std::chrono::microseconds(500);
constexpr int kRoundsAlone = 200;

std::size_t next_of(std::uint64_t ticket) {
    return ticket & kNextMask;
}
std::size_t count_of(std::uint64_t ticket) {
    return ticket >> kNextBits & kCountMask;
}

void relax_core() {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

}  // namespace

Workers::Workers(unsigned helpers) {
    for (unsigned i = 0; i < helpers; ++i)
        threads_.emplace_back([this, i] {
            name_thread("worker " + std::to_string(i + 1));
            help();
        });
}

Workers::~Workers() {
    ending_.store(true, std::memory_order_release);
    ticket_.fetch_add(std::uint64_t{1} << (kNextBits + kCountBits));
    ticket_.notify_all();
    for (std::thread& thread : threads_)
        thread.join();
}

bool Workers::do_one() {
    std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
    while (next_of(ticket) < count_of(ticket)) {
        if (!ticket_.compare_exchange_weak(ticket, ticket + 1, std::memory_order_acq_rel)) continue;
        (*work_)(next_of(ticket));
        done_.fetch_add(1, std::memory_order_release);
        return true;
    }
    return false;
}

void Workers::help() {
    int looks = 0;
    while (!ending_.load(std::memory_order_acquire)) {
        if (do_one()) {
            looks = 0;
        } else if (++looks < kLooks) {
            relax_core();
        } else {
            const std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
            if (next_of(ticket) >= count_of(ticket)) ticket_.wait(ticket, std::memory_order_acquire);
            looks = 0;
        }
    }
}

void Workers::run(std::size_t count, const Work& work) {
    if (threads_.empty() || count < 2 || alone_ > 0) {
        if (alone_ > 0) --alone_;
        for (std::size_t piece = 0; piece < count; ++piece)
            work(piece);
        return;
    }
    work_ = &work;
    done_.store(0, std::memory_order_relaxed);
    ++round_;
    ticket_.store(std::uint64_t{round_} << (kNextBits + kCountBits) | std::uint64_t{count} << kNextBits,
                  std::memory_order_release);
    ticket_.notify_all();
    while (do_one()) {
    }
    wait_for_all(count);
}

void Workers::wait_for_all(std::size_t count) {
    using Clock = std::chrono::steady_clock;
    Clock::time_point begun{};
    for (int looks = 0; done_.load(std::memory_order_acquire) < count; ++looks) {
        if (looks < kLooksBeforeYield) {
            relax_core();
            continue;
        }
        if (looks == kLooksBeforeYield) begun = Clock::now();
        std::this_thread::yield();
        if (Clock::now() - begun > kPutAside) alone_ = kRoundsAlone;
    }
}

}  // namespace puckloop::cosim
