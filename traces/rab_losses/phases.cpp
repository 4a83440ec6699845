#include "traces/rab_losses/phases.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

namespace puckloop::tools {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Median interval; 0 without one.
cosim::Time period_of(const std::vector<cosim::Time>& starts) {
    if (starts.size() < 2) return 0;
    std::vector<cosim::Time> intervals;
    for (std::size_t i = 1; i < starts.size(); ++i)
        intervals.push_back(starts[i] - starts[i - 1]);
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
    std::nth_element(intervals.begin(), middle, intervals.end());
    return *middle;
}

/// The frames of `follower` within the intervals of `leader`; nothing if they are too few.
std::optional<PhaseLock> relation(const std::vector<cosim::Time>& leader,
                                  const std::vector<cosim::Time>& follower) {
    constexpr cosim::Time kPause = 3;  // periods
    const cosim::Time period = period_of(leader);
    if (period <= 0) return std::nullopt;
    PhaseLock lock;
    std::complex<double> sum;
    for (const cosim::Time start : follower) {
        const auto next = std::upper_bound(leader.begin(), leader.end(), start);
        if (next == leader.begin() || next == leader.end()) continue;
        const cosim::Time before = *std::prev(next), interval = *next - before;
        if (interval > kPause * period) continue;
        sum += std::polar(1.0, kTurn * static_cast<double>(start - before) / static_cast<double>(interval));
        ++lock.frames;
    }
    if (lock.frames < kFewestLocked) return std::nullopt;
    const double length = std::abs(sum) / static_cast<double>(lock.frames);
    lock.period = cosim::to_seconds(period);
    lock.phase = std::arg(sum) / kTurn;
    if (lock.phase < 0) lock.phase += 1.0;
    lock.spread = length > 0 ? std::sqrt(std::max(0.0, -2.0 * std::log(length))) / kTurn : 1.0;
    return lock;
}

}  // namespace

std::vector<PhaseLock> locked_phases(const std::map<std::string, std::vector<cosim::Time>>& starts) {
    std::vector<PhaseLock> locks;
    for (auto first = starts.begin(); first != starts.end(); ++first)
        for (auto second = std::next(first); second != starts.end(); ++second) {
            // Of a pair with periods that are multiples, only the slower one follows.
            std::optional<PhaseLock> best;
            for (const auto& [leader, follower] : {std::pair{first, second}, std::pair{second, first}}) {
                std::optional<PhaseLock> found = relation(leader->second, follower->second);
                if (!found || (best && best->spread <= found->spread)) continue;
                best = found;
                best->leader = leader->first;
                best->follower = follower->first;
            }
            if (best && best->spread < kLockedSpread) locks.push_back(*best);
        }
    return locks;
}

}  // namespace puckloop::tools
