#pragma once
// Whose turn it is, the program's or the node's: one word in memory that both share. One side runs while the
// other one waits here, first by looking at the word for a moment, then asleep in the kernel (futex).
//
// Looking costs a processor, so it is done only while it pays: on a host with several processors, for about
// as long as going to sleep and being woken would take, and no more once it was often in vain, as it is
// where the other side has to wait for a processor itself.

#include <linux/futex.h>
#include <sched.h>
#include <sys/syscall.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <ctime>

namespace puckloop::linuxboard {

/// How long to look before each wait, learned from the waits before. One object for each side that waits.
class Patience {
  public:
    /// To sleep and to be woken on another processor takes 10 to 20 us on the host this was measured on, and
    /// a program's answer mostly less. Longer looks won nothing there, half as long ones less than half of
    /// what could be won.
    static constexpr std::int64_t kLook = 30'000;  // ns

    /// Nanoseconds to look this time; 0: sleep at once. `processors` that this process may use.
    std::int64_t next(int processors) {
        if (processors < 2) return 0;
        if (skip_ == 0) return kLook;
        --skip_;
        return 0;
    }
    void ended(bool in_time) {
        if (in_time) {
            confidence_ = std::min(confidence_ + 1, kMost);
            pause_ = kFirstPause;
            return;
        }
        confidence_ = std::max(confidence_ - 2, 0);
        if (confidence_ > 0) return;
        skip_ = pause_;
        pause_ = std::min(2 * pause_, kLongestPause);
    }

  private:
    static constexpr int kMost = 8;
    static constexpr int kFirstPause = 16;  // waits without a look
    static constexpr int kLongestPause = 1024;
    int confidence_ = kMost / 2;
    int skip_ = 0;
    int pause_ = kFirstPause;
};

class Turn {
  public:
    enum Side : std::uint32_t { Program = 0, Node = 1 };

    /// Nobody waits yet.
    void give(Side side) { word_.store(side, std::memory_order_release); }
    bool is(Side side) const { return (word_.load(std::memory_order_acquire) & kSide) == side; }

    /// What was written before is seen by the other side. `Host` makes the system calls:
    /// long call(long number, ...) as syscall(2), std::int64_t nanoseconds() of CLOCK_MONOTONIC.
    template <typename Host>
    void pass(Side side) {
        if ((word_.exchange(side, std::memory_order_acq_rel) & kSleeps) != 0)
            Host::call(SYS_futex, address(), FUTEX_WAKE, 1, 0L, 0L, 0L);
    }

    /// Waits until it is the turn of `side`; false after `limit` nanoseconds asleep, or after a signal.
    template <typename Host>
    bool await(Side side, Patience& patience, std::int64_t limit) {
        if (is(side)) return true;
        if (const std::int64_t look = patience.next(processors<Host>()); look > 0) {
            const bool came = look_for<Host>(side, look);
            patience.ended(came);
            if (came) return true;
        }
        constexpr std::int64_t kSecond = 1'000'000'000;
        const timespec time{limit / kSecond, limit % kSecond};
        std::uint32_t seen = word_.load(std::memory_order_acquire);
        while ((seen & kSide) != side) {
            if ((seen & kSleeps) == 0 &&
                !word_.compare_exchange_weak(seen, seen | kSleeps, std::memory_order_acq_rel))
                continue;
            const long slept = Host::call(SYS_futex, address(), FUTEX_WAIT, static_cast<long>(seen | kSleeps),
                                          reinterpret_cast<long>(&time), 0L, 0L);
            if (slept < 0 && errno != EAGAIN) return is(side);
            seen = word_.load(std::memory_order_acquire);
        }
        return true;
    }

  private:
    static constexpr std::uint32_t kSide = 1;
    static constexpr std::uint32_t kSleeps = 2;  ///< the side that waits is to be woken

    long address() { return reinterpret_cast<long>(&word_); }

    template <typename Host>
    bool look_for(Side side, std::int64_t nanoseconds) const {
        constexpr int kLooksBetweenClocks = 16;
        const std::int64_t end = Host::nanoseconds() + nanoseconds;
        do {
            for (int i = 0; i < kLooksBetweenClocks; ++i) {
                if (is(side)) return true;
#if defined(__x86_64__)
                __builtin_ia32_pause();
#endif
            }
        } while (Host::nanoseconds() < end);
        return false;
    }

    template <typename Host>
    static int processors() {
        static std::atomic<int> known{0};
        if (const int count = known.load(std::memory_order_relaxed); count != 0) return count;
        unsigned long mask[1024 / (8 * sizeof(unsigned long))] = {};
        const long bytes = Host::call(SYS_sched_getaffinity, 0L, static_cast<long>(sizeof mask),
                                      reinterpret_cast<long>(mask), 0L, 0L, 0L);
        int count = 0;
        for (const unsigned long word : mask)
            count += __builtin_popcountl(word);
        if (bytes < 0) count = 1;
        known.store(count, std::memory_order_relaxed);
        return count;
    }

    std::atomic<std::uint32_t> word_{Program};
};

}  // namespace puckloop::linuxboard
