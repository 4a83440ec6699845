#include "physics/camera/camera_port.h"

#include "physics/camera/camera_scene.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::physics {

namespace {
constexpr std::array<double, kPoseSignals> kPoseQuantum{1e-5, 1e-5, 1e-4};  // m, m, rad
constexpr double kFullLevel = 255.0;                                        // of the turret's colours

std::array<double, CameraSignals::kLampValues> values_of(const Lamp& lamp) {
    return {lamp.x, lamp.y, lamp.height, lamp.intensity};
}
}  // namespace

CameraPort::CameraPort(const WorldModel& model, std::vector<cosim::PortIndex> ports)
    : signals_(model.description()), images_(floor_images(model.description())), ports_(std::move(ports)) {
    const World& world = model.description();
    for (std::size_t r = 0; r < world.robots.size(); ++r) {
        ring_.emplace_back();
        turret_.emplace_back();
        const auto know = [](const auto& ids, const std::string& name, auto& map, std::size_t own) {
            if (const auto found = ids.find(name); found != ids.end()) map[found->second] = own;
        };
        for (std::size_t led = 0; led < kRingLeds; ++led) {
            const std::string name = led < 8    ? fmt::format("led{}", led)
                                     : led == 8 ? "led_front"
                                                : "led_body";
            know(world.robots[r].board_signals, name, ring_.back(), signals_.ring_led(r, led));
        }
        constexpr std::array<const char*, 3> kColours{"red", "green", "blue"};
        for (std::size_t c = 0; c < kTurretColours; ++c)
            know(world.robots[r].ground_signals, fmt::format("rgb{}_{}", c / 3, kColours[c % 3]),
                 turret_.back(), signals_.turret(r, c));
    }
    // What cameras know from the start.
    last_[CameraSignals::kAmbient] = world.ambient_light;
    last_[CameraSignals::kFloorGrey] = world.arena.floor_grey;
    lamps_ = std::min(world.lamps.size(), CameraSignals::kMostLamps);
    for (std::size_t i = 0; i < world.lamps.size(); ++i)
        last_[signals_.lamp(i)] = world.lamps[i].intensity;
    for (std::size_t i = 0; i < lamps_; ++i)
        for (std::size_t k = 0; k < CameraSignals::kLampValues; ++k)
            last_[CameraSignals::lamp_place(i) + k] = values_of(world.lamps[i])[k];
    for (std::size_t i = 0; i < model.fixed_count(); ++i)
        for (std::size_t k = 0; k < kShapeSignals; ++k)
            last_[signals_.shape(true, i) + k] = values_of(model.fixed(i))[k];
    for (; patches_ < world.patches.size(); ++patches_)
        for (std::size_t k = 0; k < kCameraPatchValues; ++k)
            last_[signals_.patch(patches_) + k] = values_of(world.patches[patches_], images_)[k];
}

void CameraPort::led(std::size_t robot, bool turret, std::uint16_t id, double value) {
    const auto& ids = turret ? turret_[robot] : ring_[robot];
    if (const auto found = ids.find(id); found != ids.end())
        leds_[found->second] = turret ? value / kFullLevel : value;
}

void CameraPort::put(std::size_t id, double value) {
    const auto [found, fresh] = last_.try_emplace(id, 0.0);
    if (found->second == value && !(fresh && id < signals_.out(0))) return;
    found->second = value;
    for (const cosim::PortIndex port : ports_)
        outbox_->push_back({stamp_, port, cosim::Signal{static_cast<std::uint16_t>(id), value}});
}

void CameraPort::put_shape(bool fixed, std::size_t index, const Shape& shape) {
    if (signals_.shape(fixed, index) + kShapeSignals > CameraSignals::kFirstLampPlace) return;  // thousands
    const ShapeValues values = values_of(shape);
    for (std::size_t k = 0; k < kShapeSignals; ++k)
        put(signals_.shape(fixed, index) + k, values[k]);
}

void CameraPort::put_poses(const WorldModel& model) {
    for (std::size_t i = 0; i < signals_.moving(); ++i) {
        const bool robot = i < signals_.robots();
        const auto pose = [](const auto& s) { return std::array<double, kPoseSignals>{s.x, s.y, s.heading}; };
        const auto now = robot ? pose(model.state(i)) : pose(model.object(i - signals_.robots()));
        for (std::size_t k = 0; k < kPoseSignals; ++k)
            put(signals_.pose(i) + k, std::round(now[k] / kPoseQuantum[k]) * kPoseQuantum[k]);
    }
}

/// Where lamps are now: one that goes away moves those behind it up.
void CameraPort::put_lamps(const World& world) {
    lamps_ = std::min(std::max(lamps_, world.lamps.size()), CameraSignals::kMostLamps);
    for (std::size_t i = 0; i < lamps_; ++i) {
        const bool there = i < world.lamps.size(), own = i < signals_.lamp_count();
        const auto values = there ? values_of(world.lamps[i]) : decltype(values_of(Lamp{})){};
        // The intensity of a lamp that was there from the start has a signal of its own.
        for (std::size_t k = 0; k < CameraSignals::kLampValues - (own ? 1 : 0); ++k)
            if (there || k == CameraSignals::kLampValues - 1)
                put(CameraSignals::lamp_place(i) + k, values[k]);
    }
}

/// What events can change.
void CameraPort::put_changes(const WorldModel& model) {
    const World& world = model.description();
    put(CameraSignals::kAmbient, world.ambient_light);
    put(CameraSignals::kFloorGrey, world.arena.floor_grey);
    for (std::size_t i = 0; i < signals_.robots(); ++i)
        put(signals_.out(i), model.robot(i).lifted() ? 1.0 : 0.0);
    const std::size_t movable = signals_.moving() - signals_.robots();
    for (std::size_t i = 0; i < model.object_names().size(); ++i) {
        const Shape& shape = model.object_shape(i);
        if (i < movable) {
            put(signals_.out(signals_.robots() + i), shape.height > 0.0 ? 0.0 : 1.0);
        } else {
            put_shape(false, i - movable, shape);
        }
    }
    for (std::size_t i = 0; i < model.fixed_count(); ++i)
        put_shape(true, i, model.fixed(i));
    for (std::size_t i = 0; i < signals_.lamp_count(); ++i)
        put(signals_.lamp(i), i < world.lamps.size() ? world.lamps[i].intensity : 0.0);
    put_lamps(world);
    patches_ = std::max(patches_, world.patches.size());
    for (std::size_t i = 0; i < patches_; ++i) {
        if (signals_.patch(i) + kCameraPatchValues > CameraSignals::kFirstLampPlace) return;
        const auto values = i < world.patches.size() ? values_of(world.patches[i], images_)
                                                     : std::array<double, kCameraPatchValues>{};
        for (std::size_t k = 0; k < kCameraPatchValues; ++k)
            put(signals_.patch(i) + k, values[k]);
    }
}

void CameraPort::publish(const WorldModel& model, bool events, cosim::Time stamp,
                         std::vector<cosim::Message>& outbox) {
    if (next_camera_message(stamp) != stamp) return;
    stamp_ = stamp;
    outbox_ = &outbox;
    put_poses(model);
    for (const auto& [id, value] : leds_)
        put(id, value);
    for (std::size_t i = 0; i < signals_.booth_lights(); ++i) {
        const ColouredLight& light = model.booth(i / booth::kLights).lights()[i % booth::kLights];
        put(signals_.booth_light(i, 0), light.red);
        put(signals_.booth_light(i, 1), light.green);
        put(signals_.booth_light(i, 2), light.blue);
    }
    if (events) put_changes(model);
    outbox_ = nullptr;
}

}  // namespace puckloop::physics
