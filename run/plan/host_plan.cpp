#include "run/plan/host_plan.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>

namespace puckloop::tools {

namespace {

// A range-and-bearing board takes about as much as the rest of its robot (docs/performance.md).
constexpr double kRobotWork = 1.0, kRabWork = 1.0, kBoothWork = 1.0;
// So much of all the work may be on the wrong side of a cut for the sake of a wider gap.
constexpr double kUneven = 0.1;

class Cuts {
  public:
    explicit Cuts(std::span<const StandingUnit> units) : units_(units), parts_(units.size(), 0) {}

    /// `which` go to `count` parts from `first` on.
    void cut(std::span<std::size_t> which, unsigned first, unsigned count) {
        if (count == 1 || which.size() < 2) {
            for (const std::size_t unit : which)
                parts_[unit] = first;
            return;
        }
        sort_along(which);
        const unsigned left = count / 2;
        const std::size_t at = place(which, static_cast<double>(left) / count);
        cut(which.first(at), first, left);
        cut(which.subspan(at), first + left, count - left);
    }
    std::vector<unsigned> parts() { return std::move(parts_); }

  private:
    void sort_along(std::span<std::size_t> which) {
        const auto extent = [&](auto of) {
            const auto [low, high] = std::minmax_element(
                which.begin(), which.end(), [&](auto a, auto b) { return of(units_[a]) < of(units_[b]); });
            return of(units_[*high]) - of(units_[*low]);
        };
        by_x_ = extent([](const StandingUnit& u) { return u.x; }) >=
                extent([](const StandingUnit& u) { return u.y; });
        std::stable_sort(which.begin(), which.end(), [this](auto a, auto b) { return along(a) < along(b); });
    }
    double along(std::size_t unit) const { return by_x_ ? units_[unit].x : units_[unit].y; }

    /// How many of them lie before the cut that leaves `share` of the work there, about; one at least.
    std::size_t place(std::span<const std::size_t> which, double share) const {
        double all = 0.0;
        for (const std::size_t unit : which)
            all += units_[unit].work;
        std::size_t nearest = 1, widest = 0;
        double before = 0.0, least = 2.0, gap = -1.0;
        for (std::size_t i = 1; i < which.size(); ++i) {
            before += units_[which[i - 1]].work;
            const double off = std::abs(before / all - share);
            if (off < least) {
                least = off;
                nearest = i;
            }
            if (const double here = along(which[i]) - along(which[i - 1]); off <= kUneven && here > gap) {
                gap = here;
                widest = i;
            }
        }
        return widest != 0 ? widest : nearest;
    }

    std::span<const StandingUnit> units_;
    std::vector<unsigned> parts_;
    bool by_x_ = true;
};

}  // namespace

std::vector<unsigned> parts_of(std::span<const StandingUnit> units, unsigned parts) {
    std::vector<std::size_t> all(units.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    Cuts cuts(units);
    cuts.cut(all, 0, parts);
    return cuts.parts();
}

void plan_hosts(RunSetup& setup, unsigned hosts) {
    if (hosts == 0) return;
    const physics::World& world = setup.scenario.world;
    std::vector<StandingUnit> units;
    std::map<std::string, std::size_t> by_name;
    for (const physics::Robot& robot : world.robots) {
        by_name.emplace(robot.name, units.size());
        units.push_back({robot.x, robot.y, kRobotWork + (robot.rab ? kRabWork : 0.0)});
    }
    for (const physics::Booth& booth : world.booths) {
        by_name.emplace(booth.name, units.size());
        units.push_back({booth.x, booth.y, kBoothWork});
    }
    const std::vector<unsigned> parts = parts_of(units, hosts);
    for (PlannedNode& node : setup.nodes) {
        const auto unit = by_name.find(node.name.substr(0, node.name.find('.')));
        if (unit != by_name.end() && !node.in_process.value_or(false)) node.host = parts[unit->second] + 1;
    }
}

}  // namespace puckloop::tools
