// What faults do to the program's process.

#include "linuxboard/shim/node/linux_node.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::linuxboard {

using cosim::Time;

namespace {

wire::Charges times(const wire::Charges& charges, double factor) {
    const auto of = [factor](std::int64_t charge) {
        return static_cast<std::int64_t>(std::llround(static_cast<double>(charge) * factor));
    };
    return {of(charges.clock), of(charges.device), of(charges.sync), of(charges.thread), of(charges.yield)};
}

}  // namespace

void LinuxNode::apply_faults(Time now) {
    const ProcessDamage damage = faults_.happen(now, !clients_.empty() && end_signal_ == 0);
    if (damage.charge_factor) launcher_->page().charges = times(spec_.charges, *damage.charge_factor);
    if (damage.paused_until > paused_until_) {
        paused_until_ = damage.paused_until;
        kernel_.hold_calls(paused_until_);
    }
    if (damage.hung_up) kernel_.hang_up(now);
    if (!damage.killed) return;
    kill_all(now);
    paused_until_ = 0;
    end_ = "was killed by a fault";
    if (damage.restarted_at) {
        start_at_ = *damage.restarted_at;
    } else if (damage.ends_run) {
        end_run(now, false, fmt::format("{} {}", spec_.program, end_), 1);
    } else {
        warn(fmt::format("{} {} (at {:.6f} s)", spec_.program, end_, cosim::to_seconds(now)));
    }
}

}  // namespace puckloop::linuxboard
