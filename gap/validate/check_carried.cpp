// Where a robot went without its wheels: lifted and put down, pushed, or a tracker that took another thing
// for it. What the wheels did not do no cause of the catalogue explains but pushes.

#include "gap/stats/robust.h"
#include "gap/validate/checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace puckloop::gap {

namespace {

constexpr double kCarried = 0.05, kTurnedBy = 0.35;  // m, rad: no tracker's noise, no marker's swing
constexpr double kFollowsLate = 3.0;                 // times as far, where there are commands only
constexpr double kCarriedDeviations = 8.0;           // robust ones, of what rows differ by
constexpr double kStanding = 1e-4;                   // m a row: the wheels stand
constexpr std::size_t kMostCarriedListed = 6;        // of a run

/// Rows [first, last] in which the robot went `far` (m), or turned by `turned` (rad), without its wheels.
struct Carried {
    std::size_t first, last;
    double far, turned;
    bool jumps;
};

class TrackedDrive {
  public:
    TrackedDrive(const Experiment& experiment, const Run& run)
        : run_(run),
          x_(run.column("x_m")),
          y_(run.column("y_m")),
          theta_(run.column("theta_rad")),
          counted_(run.has("steps_left")),
          metre_(metres_per_step(experiment)) {}

    /// By counters: a robot follows its commands late.
    bool counted() const { return counted_; }
    bool known(std::size_t row) const { return std::isfinite(x_[row] + y_[row] + theta_[row]); }
    /// m that either wheel went into this row, the faster one.
    double wheels(std::size_t row) const {
        const auto [left, right] = steps_made(run_, row);
        const double most = std::max(std::abs(left), std::abs(right)) * metre_;
        return std::isnan(most) ? 0.0 : most;
    }
    double far(std::size_t from, std::size_t to) const {
        return std::hypot(x_[to] - x_[from], y_[to] - y_[from]);
    }
    double turned(std::size_t from, std::size_t to) const {
        return std::abs(std::remainder(theta_[to] - theta_[from], 2 * std::numbers::pi));
    }

  private:
    const Run& run_;
    const std::vector<double>&x_, &y_, &theta_;
    bool counted_;
    double metre_;
};

/// Rows into which the robot went much further than its wheels.
std::vector<Carried> carried_jumps(const TrackedDrive& drive, std::size_t rows) {
    std::vector<double> beyond;
    std::vector<std::pair<std::size_t, std::size_t>> steps;
    std::size_t last = rows;
    double wheels = 0.0;
    for (std::size_t i = 0; i < rows; ++i) {
        wheels += i > 0 ? drive.wheels(i) : 0.0;
        if (!drive.known(i)) continue;
        if (last < rows) {
            steps.emplace_back(last, i);
            beyond.push_back(drive.far(last, i) - wheels);
        }
        last = i;
        wheels = 0.0;
    }
    std::vector<Carried> found;
    if (beyond.empty()) return found;
    std::vector<double> sizes = beyond;
    const double middle = stats::upper_median(sizes);
    for (double& one : sizes)
        one = std::abs(one - middle);
    const double most =
        std::max(kCarried * (drive.counted() ? 1.0 : kFollowsLate),
                 middle + kCarriedDeviations * stats::kMadToSigma * stats::upper_median(sizes));
    for (std::size_t k = 0; k < beyond.size(); ++k) {
        if (!(beyond[k] > most)) continue;
        const auto [from, to] = steps[k];
        if (!found.empty() && from <= found.back().last + 2) {  // goes on, or is put down
            found.back().last = to;
            found.back().far = drive.far(found.back().first, to);
            found.back().turned = drive.turned(found.back().first, to);
            found.back().jumps = false;
        } else {
            found.push_back({from, to, drive.far(from, to), drive.turned(from, to), true});
        }
    }
    return found;
}

/// Stretches in which the wheels stand and the robot goes.
std::vector<Carried> stretches_of_standing(const TrackedDrive& drive, std::size_t rows) {
    std::vector<Carried> found;
    if (!drive.counted()) return found;
    for (std::size_t i = 1, begin = 0; i <= rows; ++i) {
        if (i < rows && drive.wheels(i) < kStanding) continue;
        std::size_t first = begin, last = i - 1;
        while (first < last && !drive.known(first))
            ++first;
        while (last > first && !drive.known(last))
            --last;
        if (last > first) {
            const double far = drive.far(first, last), turned = drive.turned(first, last);
            if (far > kCarried || turned > kTurnedBy) found.push_back({first, last, far, turned, false});
        }
        begin = i;
    }
    return found;
}

std::string words_of(const Carried& one) {
    if (one.jumps && one.last == one.first + 1)
        return fmt::format("into row {} by {:.2g} m", one.last + 1, one.far);
    return fmt::format("rows {} to {} by {:.2g} m{}", one.first + 1, one.last + 1, one.far,
                       one.turned > kTurnedBy ? fmt::format(" and {:.2g} rad", one.turned) : "");
}

}  // namespace

void check_carried(Experiment& experiment) {
    for (const Run& run : experiment.runs) {
        if (!run.has("steps_left") && !run.has("cmd_left")) continue;
        const TrackedDrive drive(experiment, run);
        std::vector<Carried> all = stretches_of_standing(drive, run.rows);
        for (const Carried& jump : carried_jumps(drive, run.rows))
            if (std::ranges::none_of(
                    all, [&](const Carried& one) { return jump.last > one.first && jump.first < one.last; }))
                all.push_back(jump);
        std::ranges::sort(all, {}, &Carried::first);
        if (all.empty()) continue;
        std::vector<std::string> words;
        for (const Carried& one : all)
            if (words.size() < kMostCarriedListed) words.push_back(words_of(one));
        const std::size_t more = all.size() - words.size();
        experiment.caution(
            "{}: the robot went without its wheels {} time{}: {}{}: carried, pushed, or lost by "
            "the tracker; cut the run there, or leave these poses empty",
            run.file, all.size(), all.size() == 1 ? "" : "s", fmt::join(words, ", "),
            more == 0 ? "" : fmt::format(" and {} more", more));
    }
}

}  // namespace puckloop::gap
