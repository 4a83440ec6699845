#include "physics/ircom/scene.h"

#include "physics/description/booth.h"
#include "physics/description/robot_parameters.h"
#include "physics/world/pose_signals.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace puckloop::physics {

namespace {

constexpr double kFaintest = 0.25;  // counts: less is left out
constexpr double kSlack = 0.1;      // m: sensors are not in the middles of their bodies

}  // namespace

IrcomScene::IrcomScene(const World& world, bool changes) : changes_(changes), fixed_(fixed_shapes(world)) {
    for (const Robot& robot : world.robots) {
        const Parameters parameters = parameters_of(world, robot);
        const auto parts = ircom_parts(parameters.proximity);
        devices_.push_back({robot.name,
                            false,
                            now_.size(),
                            {parts.begin(), parts.end()},
                            parameters.proximity.height,
                            parameters.ircom});
        now_.push_back({robot.x, robot.y, robot.heading, false});
        const auto& body = parameters.robot;
        bodies_.push_back(circle_shape(robot.x, robot.y, body.radius, body.height, body.reflectivity));
    }
    const auto add_movable = [this](const auto& things, const auto& heading_of) {
        for (const auto& thing : things) {
            if (!thing.movable) continue;
            now_.push_back({thing.x, thing.y, heading_of(thing), false});
            bodies_.push_back(shape_of(thing));
        }
    };
    add_movable(world.boxes, [](const Box& box) { return box.heading; });
    add_movable(world.cylinders, [](const Cylinder&) { return 0.0; });
    const IrcomParameters of_world = with({}, world.parameters).ircom;
    for (const Booth& booth : world.booths) {
        const auto& at = booth::kTransceiver;
        const IrcomPart own{at[0], at[1], booth::kTransceiverLooks[0], booth::kTransceiverLooks[1]};
        const IrcomPart part =
            in_world(own, booth.x, booth.y, std::cos(booth.heading), std::sin(booth.heading));
        devices_.push_back({booth.name, true, 0, {part}, at[2], of_world});
    }
    known_ = now_;
    for (const Shape& body : bodies_)
        heights_.push_back(body.height);
    near_.resize(devices_.size());
    placed_.resize(devices_.size());
    rows_.resize(devices_.size() * kIrcomLines);
    place_all();
}

void IrcomScene::set(std::vector<Body>& bodies, std::size_t id, double value) {
    const SceneSignals ids{bodies.size()};
    if (id >= ids.out(0)) {
        bodies[id - ids.out(0)].out = value != 0.0;
        return;
    }
    Body& body = bodies[id / kPoseSignals];
    const std::array<double*, kPoseSignals> members{&body.x, &body.y, &body.heading};
    *members[id % kPoseSignals] = value;
}

void IrcomScene::set_shape(std::size_t id, double value) {
    const std::size_t offset = id - SceneSignals{now_.size()}.shape(true, 0);
    const std::size_t number = offset / kShapeSignals;
    auto& shapes = number % 2 == 0 ? fixed_ : added_;
    if (shapes.size() <= number / 2) shapes.resize(number / 2 + 1);
    ShapeValues values = values_of(shapes[number / 2]);
    values[offset % kShapeSignals] = value;
    shapes[number / 2] = shape_from(values);
}

void IrcomScene::take(cosim::Time now, std::size_t id, double value) {
    pending_.push_back({now + kIrcomPoseDelay, id, value});
    if (id >= SceneSignals{known_.size()}.out(known_.size())) return;  // a shape moves nobody
    set(known_, id, value);
    near_stale_ = true;
}

bool IrcomScene::apply(cosim::Time now) {
    if (next_change() > now) return false;
    const std::size_t first_shape = SceneSignals{now_.size()}.out(now_.size());
    for (; next_change() <= now; pending_.pop_front()) {
        const Pending& change = pending_.front();
        if (change.id >= first_shape)
            set_shape(change.id, change.value);
        else
            set(now_, change.id, change.value);
    }
    version_ = ++versions_;
    place_all();
    near_stale_ = true;
    return true;
}

void IrcomScene::place_all() {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        bodies_[i].place(now_[i].x, now_[i].y, now_[i].heading);
        bodies_[i].height = now_[i].out ? 0.0 : heights_[i];
    }
    for (std::size_t d = 0; d < devices_.size(); ++d)
        place(d);
}

void IrcomScene::place(std::size_t device) {
    const Device& from = devices_[device];
    Placed& to = placed_[device];
    to.parts = from.parts;
    if (from.booth) {
        to.x = from.parts[0].x;
        to.y = from.parts[0].y;
        return;
    }
    const Body& body = now_[from.body];
    to.x = body.x;
    to.y = body.y;
    to.out = body.out;
    const double cosine = std::cos(body.heading);
    const double sine = std::sin(body.heading);
    for (IrcomPart& part : to.parts)
        part = in_world(part, body.x, body.y, cosine, sine);
}

bool IrcomScene::close(std::size_t a, std::size_t b, const std::vector<Body>& bodies) const {
    const auto middle = [&](const Device& device) {
        return device.booth ? Point{device.parts[0].x, device.parts[0].y}
                            : Point{bodies[device.body].x, bodies[device.body].y};
    };
    const Point first = middle(devices_[a]);
    const Point second = middle(devices_[b]);
    const double reach = std::max(devices_[a].parameters.reach, devices_[b].parameters.reach) + kSlack;
    const double x = first.x - second.x;
    const double y = first.y - second.y;
    return x * x + y * y < reach * reach;
}

/// By where things are and by where they will be. Booths only look into themselves.
void IrcomScene::find_near() const {
    near_stale_ = false;
    std::fill(near_.begin(), near_.end(), std::uint8_t{0});
    for (std::size_t a = 0; a < devices_.size(); ++a)
        for (std::size_t b = a + 1; b < devices_.size(); ++b) {
            if ((near_[a] != 0 && near_[b] != 0) || (is_booth(a) && is_booth(b))) continue;
            if (close(a, b, now_) || close(a, b, known_)) near_[a] = near_[b] = 1;
        }
}

std::vector<const Shape*> IrcomScene::between(std::size_t a, std::size_t b) const {
    const Placed& from = placed_[a];
    const Placed& to = placed_[b];
    const double height = std::min(devices_[a].height, devices_[b].height);
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    const double length = std::hypot(dx, dy);
    std::vector<const Shape*> shapes;
    const auto see = [&](const Shape& shape) {
        if (shape.height <= height) return;
        const double x = shape.x - from.x;
        const double y = shape.y - from.y;
        const double along = length > 0.0 ? std::clamp((x * dx + y * dy) / length, 0.0, length) : 0.0;
        const double near_x = length > 0.0 ? x - along * dx / length : x;
        const double near_y = length > 0.0 ? y - along * dy / length : y;
        if (std::hypot(near_x, near_y) < kSlack + shape.radius) shapes.push_back(&shape);
    };
    for (const Shape& shape : fixed_)
        see(shape);
    for (const Shape& shape : added_)
        see(shape);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const bool own = (!is_booth(a) && devices_[a].body == i) || (!is_booth(b) && devices_[b].body == i);
        if (!own) see(bodies_[i]);
    }
    return shapes;
}

void IrcomScene::couple(std::size_t device, std::size_t line, std::vector<IrcomShare>& shares) const {
    shares.clear();
    const Placed& from = placed_[device];
    const IrcomParameters& sender = devices_[device].parameters;
    const double power = is_booth(device) ? sender.tam_power : sender.power;
    if (from.out || power <= 0.0) return;
    for (std::size_t r = 0; r < devices_.size(); ++r) {
        const Placed& to = placed_[r];
        if (r == device || to.out || (is_booth(device) && is_booth(r)) || !close(device, r, now_)) continue;
        const double scale = power * (is_booth(r) ? 1.0 : devices_[r].parameters.gain);
        std::vector<const Shape*> shapes;
        bool looked = false;
        for (std::size_t k = 0; k < to.parts.size(); ++k) {
            double sum = 0.0;
            for (std::size_t e = line; e < from.parts.size(); e += kIrcomLines) {
                const double counts = scale * ircom_counts(from.parts[e], to.parts[k], sender);
                if (counts < kFaintest) continue;
                if (!looked) shapes = between(device, r);
                looked = true;
                if (!ircom_shaded(from.parts[e], to.parts[k], shapes)) sum += counts;
            }
            if (sum > 0.0)
                shares.push_back({static_cast<std::uint16_t>(r), static_cast<std::uint16_t>(k), sum});
        }
    }
}

const std::vector<IrcomShare>& IrcomScene::light_of(std::size_t device, std::size_t line) const {
    Row& row = rows_[device * kIrcomLines + line];
    if (row.version != version_) {
        couple(device, line, row.shares);
        row.version = version_;
    }
    return row.shares;
}

}  // namespace puckloop::physics
