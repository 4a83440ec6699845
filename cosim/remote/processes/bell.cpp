#include "cosim/remote/processes/bell.h"

#include "cosim/core/cores.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <ctime>

namespace puckloop::cosim {

namespace {

static_assert(std::atomic<std::uint32_t>::is_always_lock_free && sizeof(std::atomic<std::uint32_t>) == 4);

// About what it costs to sleep and to be woken on another core.
constexpr std::chrono::microseconds kLook{20};
constexpr int kLooksBetweenClocks = 16;
// A ring that ends every wait, for however many rings it is.
constexpr std::uint32_t kAtOnce = 1u << 16;
// A count that changes is looked at again, but not for ever: it may be nonsense.
constexpr int kChanges = 1000;
// After so many looks in vain in a row the pauses without looking grow no further.
constexpr std::uint32_t kLongestPause = 10;

/// False when a wait did not begin because the word had changed.
bool futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value, const timespec* limit) {
    return syscall(SYS_futex, &word, operation, value, limit, nullptr, 0) >= 0 || errno != EAGAIN;
}

}  // namespace

Bell::Bell(BellState& state, Busy& busy) : state_(state), busy_(busy), cores_(usable_cores()) {}

bool Bell::rung(std::uint32_t wake_at) const {
    return static_cast<std::int32_t>(rings() - wake_at) >= 0;
}

void Bell::ring(bool at_once) {
    // Either the sleeper sees the count, or this sees that it sleeps.
    state_.rings.fetch_add(at_once ? kAtOnce : 1, std::memory_order_seq_cst);
    if (state_.asleep.load(std::memory_order_seq_cst) == 0) return;
    if (!rung(state_.wake_at.load(std::memory_order_relaxed))) return;
    if (state_.asleep.exchange(0, std::memory_order_seq_cst) == 0) return;
    busy_.processes.fetch_add(1, std::memory_order_relaxed);
    futex(state_.rings, FUTEX_WAKE, INT_MAX, nullptr);
}

void Bell::wait(std::uint32_t seen, std::uint32_t more, std::chrono::nanoseconds limit) {
    const std::uint32_t wake_at = seen + more;
    if (!look(wake_at)) sleep(wake_at, limit);
}

/// No core to spare for one that only looks.
bool Bell::crowded() const {
    const bool one_core = busy_.core.load(std::memory_order_relaxed) != kAnyCore;
    return busy_.processes.load(std::memory_order_relaxed) > (one_core ? 1 : cores_);
}

bool Bell::look(std::uint32_t wake_at) {
    if (rung(wake_at)) return true;
    if (skip_ > 0) {
        --skip_;
        return false;
    }
    if (crowded()) return false;
    const auto end = std::chrono::steady_clock::now() + kLook;
    do {
        for (int looks = 0; looks < kLooksBetweenClocks; ++looks) {
            if (rung(wake_at)) {
                in_vain_ = 0;
                return true;
            }
            relax_core();
        }
        if (crowded()) return false;
    } while (std::chrono::steady_clock::now() < end);
    skip_ = 1u << in_vain_;
    in_vain_ = std::min(in_vain_ + 1, kLongestPause);
    return false;
}

void Bell::sleep(std::uint32_t wake_at, std::chrono::nanoseconds limit) {
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(limit);
    const timespec time{whole.count(), (limit - whole).count()};
    state_.wake_at.store(wake_at, std::memory_order_relaxed);
    busy_.processes.fetch_sub(1, std::memory_order_relaxed);
    state_.asleep.store(1, std::memory_order_seq_cst);
    for (int changes = 0; changes < kChanges; ++changes) {
        const std::uint32_t count = rings();
        if (static_cast<std::int32_t>(count - wake_at) >= 0) break;
        if (futex(state_.rings, FUTEX_WAIT, count, &time)) break;
    }
    if (state_.asleep.exchange(0, std::memory_order_seq_cst) != 0)
        busy_.processes.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace puckloop::cosim
