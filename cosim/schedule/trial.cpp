#include "cosim/schedule/trial.h"

#include <algorithm>

namespace puckloop::cosim {

/// How fast it went. Where nodes chatter a grant takes little simulated and little wall time, where they work
/// much of both: the product of the two rates does not depend on which stretch a slice met.
double Trial::Progress::rate() const {
    return wall > 0 ? time * grants / (wall * wall) : 0;
}

bool Trial::step(double wall, Time time, std::uint64_t grants) {
    if (wall < until_) return second_;
    const Progress now{wall, to_seconds(time), static_cast<double>(grants)};
    if (slice_ < rule_.slices) {
        Progress& tried = tried_[second_];
        tried.wall += now.wall - before_.wall;
        tried.time += now.time - before_.time;
        tried.grants += now.grants - before_.grants;
        ++slice_;
    } else {
        slice_ = 0;
        tried_[0] = tried_[1] = {};
    }
    before_ = now;
    if (slice_ == rule_.slices) {
        choose();
        until_ = wall + hold_;
    } else {
        second_ = slice_ % 4 == 1 || slice_ % 4 == 2;
        until_ = wall + rule_.slice;
    }
    return second_;
}

void Trial::choose() {
    second_ = tried_[1].rate() > rule_.margin * tried_[0].rate();
    hold_ =
        second_ == chosen_ ? std::clamp(2 * hold_, rule_.first_hold, rule_.longest_hold) : rule_.first_hold;
    chosen_ = second_;
}

}  // namespace puckloop::cosim
