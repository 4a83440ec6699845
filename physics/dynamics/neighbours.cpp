#include "physics/dynamics/neighbours.h"

namespace puckloop::physics {

namespace {
constexpr double kRounding = 1e-6;  // m: far above any rounding of these sums
}

void Neighbours::make(std::vector<Disc> moving, std::span<const double> reach,
                      std::span<const Shape* const> fixed) {
    places_ = std::move(moving);
    lists_.resize(reach.size());
    for (std::size_t i = 0; i < reach.size(); ++i) {
        const Disc& own = places_[i];
        Lists& lists = lists_[i];
        lists.fixed.clear();
        lists.moving.clear();
        const double to_fixed = reach[i] + slack_ + kRounding;
        for (std::size_t k = 0; k < fixed.size(); ++k)
            if (within(*fixed[k], own.x, own.y, to_fixed))
                lists.fixed.push_back(static_cast<std::uint32_t>(k));
        const double to_moving = reach[i] + 2 * slack_ + kRounding;  // both may come nearer
        for (std::size_t k = 0; k < places_.size(); ++k) {
            const double dx = places_[k].x - own.x, dy = places_[k].y - own.y;
            const double far = to_moving + places_[k].radius;
            if (k != i && dx * dx + dy * dy < far * far)
                lists.moving.push_back(static_cast<std::uint32_t>(k));
        }
    }
    made_ = true;
}

}  // namespace puckloop::physics
