#include "linuxboard/control/rab_session.h"

#include "linuxboard/control/behaviours/calibrate.h"

#include <cstdio>

namespace puckloop::control {

RabSession::RabSession(const Options& options, Clock& clock, Log log)
    : id_(options.rab_id),
      clock_(clock),
      log_(std::move(log)),
      device_(options.i2c.empty() ? kDefaultBus : options.i2c, rab::kAddress),
      board_(device_, clock, options.board),
      link_(board_, clock, log_, options.link),
      neighbourhood_(options.rab_id, options.rab_gain) {}

bool RabSession::start() {
    if (!set_up()) return false;
    say(0);
    link_.start();
    return true;
}

int RabSession::calibrate(const Options& options, const std::function<bool()>& interrupted) {
    CalibrationSettings settings{options.calibrate, options.rab_id, options.link.poll_period};
    if (options.loop.duration > 0) settings.duration = options.loop.duration;
    const RangeCalibration result = calibrate_range(board_, clock_, interrupted, settings);
    if (!result.gain()) {
        std::fprintf(stderr,
                     "puckloop-control: calibration: %d of %d messages in %.0f s; is a robot with another id "
                     "sending 20 cm away?\n",
                     result.count(), options.calibrate, settings.duration);
        return 1;
    }
    std::printf("%d messages, strength %.1f, standard deviation %.1f\n--rab-gain %.6g\n", result.count(),
                result.mean_strength(), result.deviation(), *result.gain());
    return 0;
}

std::vector<Neighbour> RabSession::neighbours() {
    const double now = clock_.now();
    neighbourhood_.update(now, link_.take());
    if (const std::string line = neighbourhood_.delivery(now); !line.empty()) log_(line);
    return neighbourhood_.list(now);
}

void RabSession::say(std::uint32_t data) {
    link_.say(data << kIdBits | static_cast<std::uint32_t>(id_));
}

void RabSession::report() const {
    const RabLinkCounters c = link_.counters();
    std::printf("range and bearing: frames sent %lu, messages received %lu, not taken %lu\n", c.sent,
                c.received, c.dropped);
    std::printf("range and bearing bus: transfers %lu, repeated %lu, failed %lu, board set up %lu\n",
                c.bus.transfers, c.bus.retries, c.bus.failures, c.setups);
}

}  // namespace puckloop::control
