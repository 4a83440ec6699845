#include "linuxboard/control/behaviours/calibrate.h"

#include "linuxboard/control/behaviours/neighbours.h"

namespace puckloop::control {

RangeCalibration calibrate_range(RabBoard& board, Clock& clock, const std::function<bool()>& interrupted,
                                 const CalibrationSettings& settings) {
    RangeCalibration calibration(settings.messages, settings.own_id);
    const double begun = clock.now();
    while (!calibration.complete() && !interrupted()) {
        const double now = clock.now();
        if (settings.duration > 0 && now - begun >= settings.duration) break;
        RabPacket packet;
        for (int i = 0; i < rab::kQueue && board.poll(packet) == RabPoll::Message; ++i)
            calibration.add(static_cast<int>(packet.payload & kIdMask), packet.bearing, packet.strength);
        clock.sleep_until(now + settings.poll_period);
    }
    return calibration;
}

}  // namespace puckloop::control
