#include "emu/wifi/obstacles.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace puckloop::wifi {

namespace {

constexpr int kAwayValue = 3, kShape = 4;

/// Does the line from (-|) `a` to `b`, both in the box's own frame, touch it? By slabs.
bool crosses_box(const Position& a, const Position& b, double half_length, double half_width) {
    double begin = 0, end = 1;
    for (const auto& [axis, half] : {std::pair(std::size_t{0}, half_length), {std::size_t{1}, half_width}}) {
        const double way = b[axis] - a[axis];
        if (way == 0) {
            if (std::abs(a[axis]) >= half) return false;
            continue;
        }
        const double one = (-half - a[axis]) / way, other = (half - a[axis]) / way;
        begin = std::max(begin, std::min(one, other));
        end = std::min(end, std::max(one, other));
    }
    return begin < end;
}

bool crosses_circle(const Position& a, const Position& b, double radius) {
    const double x = b[0] - a[0], y = b[1] - a[1], square = x * x + y * y;
    const double along = square == 0 ? 0.0 : std::clamp(-(a[0] * x + a[1] * y) / square, 0.0, 1.0);
    return std::hypot(a[0] + along * x, a[1] + along * y) < radius;
}

/// In the frame of the obstacle.
Position seen_from(const Obstacle& one, const Position& at) {
    const double x = at[0] - one.x, y = at[1] - one.y, c = std::cos(one.heading), s = std::sin(one.heading);
    return {c * x + s * y, c * y - s * x};
}

}  // namespace

Obstacles::Obstacles(std::vector<Obstacle> list, int first_shape, double loss)
    : list_(std::move(list)), first_shape_(first_shape), loss_(loss) {
    for (std::size_t i = 0; i < list_.size(); ++i)
        know(i);
}

void Obstacles::know(std::size_t obstacle) {
    const Obstacle& one = list_[obstacle];
    for (int i = 0; one.pose >= 0 && i < kAwayValue; ++i)
        signals_[one.pose + i] = {obstacle, i};
    if (one.away >= 0) signals_[one.away] = {obstacle, kAwayValue};
    for (int i = 0; one.shape >= 0 && i < static_cast<int>(kObstacleSignals); ++i)
        signals_[one.shape + i] = {obstacle, kShape + i};
}

bool Obstacles::take(int signal, double value) {
    auto found = signals_.find(signal);
    if (found == signals_.end()) {
        if (first_shape_ < 0 || signal < first_shape_) return false;
        // Something that was added to the world.
        constexpr int kSize = static_cast<int>(kObstacleSignals);
        Obstacle added;
        added.loss = loss_;
        added.out = true;
        added.shape = first_shape_ + (signal - first_shape_) / kSize * kSize;
        list_.push_back(std::move(added));
        know(list_.size() - 1);
        found = signals_.find(signal);
    }
    Obstacle& one = list_[found->second.obstacle];
    switch (found->second.value) {
    case 0:
    case kShape + 1:
        one.x = value;
        break;
    case 1:
    case kShape + 2:
        one.y = value;
        break;
    case 2:
    case kShape + 3:
        one.heading = value;
        break;
    case kAwayValue:
        one.out = value != 0;
        break;
    case kShape:
        one.box = value != 0;
        break;
    case kShape + 4:
        one.length = 2 * value;
        break;
    case kShape + 5:
        one.width = 2 * value;
        break;
    case kShape + 6:
        one.out = value == 0;
        break;
    default:  // how well it reflects light
        break;
    }
    return true;
}

double Obstacles::loss_between(const Position& a, const Position& b) const {
    double loss = 0;
    for (const Obstacle& one : list_) {
        if (one.out || one.loss == 0) continue;
        const Position from = seen_from(one, a), to = seen_from(one, b);
        if (one.box ? crosses_box(from, to, one.length / 2, one.width / 2)
                    : crosses_circle(from, to, one.length / 2))
            loss += one.loss;
    }
    return loss;
}

}  // namespace puckloop::wifi
