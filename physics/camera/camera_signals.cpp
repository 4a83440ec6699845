#include "physics/camera/camera_signals.h"

#include "physics/description/booth.h"

namespace puckloop::physics {

CameraSignals::CameraSignals(const World& world)
    : robots_(world.robots.size()),
      moving_(moving_names(world).size()),
      outs_(pose(moving_)),
      ring_(outs_ + moving_),
      turret_(ring_ + robots_ * kRingLeds),
      lamps_(turret_ + robots_ * kTurretColours),
      lights_(lamps_ + world.lamps.size()),
      open_(lights_ + 3 * booth::kLights * world.booths.size()) {}

CameraSignals::Meaning CameraSignals::meaning(std::size_t id) const {
    if (id == kAmbient) return {Kind::Ambient, 0, 0};
    if (id == kFloorGrey) return {Kind::FloorGrey, 0, 0};
    const auto of = [id](Kind kind, std::size_t first, std::size_t values) -> Meaning {
        return {kind, (id - first) / values, (id - first) % values};
    };
    if (id < outs_) return of(Kind::Pose, pose(0), kPoseSignals);
    if (id < ring_) return of(Kind::Out, outs_, 1);
    if (id < turret_) return of(Kind::RingLed, ring_, kRingLeds);
    if (id < lamps_) return of(Kind::Turret, turret_, kTurretColours);
    if (id < lights_) return of(Kind::Lamp, lamps_, 1);
    if (id < open_) return of(Kind::BoothLight, lights_, 3);
    if (id >= kFirstLampPlace)
        return {Kind::LampPlace, kMostLamps - 1 - (id - kFirstLampPlace) / kLampValues,
                (id - kFirstLampPlace) % kLampValues};
    const std::size_t record = (id - open_) / kShapeSignals;
    constexpr Kind kLists[] = {Kind::Fixed, Kind::Added, Kind::Patch};
    return {kLists[record % 3], record / 3, (id - open_) % kShapeSignals};
}

cosim::Time next_camera_message(cosim::Time time) {
    const cosim::Time first = (time + cosim::kMillisecond - 1) / cosim::kMillisecond * cosim::kMillisecond;
    // The frame whose message time is not before `first`.
    std::int64_t frame = first / cosim::kSecond * kCameraRate;
    const auto message = [](std::int64_t f) {
        return camera_frame_time(f) / cosim::kMillisecond * cosim::kMillisecond;
    };
    while (message(frame) < first)
        ++frame;
    return message(frame);
}

}  // namespace puckloop::physics
