// Where things are, and where they can be.

#include "base/text/suggest.h"
#include "physics/description/booth.h"
#include "physics/events/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

using PlaceKind = Found::Kind;

template <class Things>
std::size_t index_of(const Things& things, std::string_view name) {
    const auto found =
        std::find_if(things.begin(), things.end(), [&](const auto& thing) { return thing.name == name; });
    return static_cast<std::size_t>(found - things.begin());
}

}  // namespace

Found Scene::find(std::string_view name) const {
    const World& world = model_.description_;
    if (const auto i = index_of(world.robots, name); i < world.robots.size()) return {PlaceKind::Robot, i};
    for (std::size_t i = built_in_; i < model_.fixed_.size(); ++i)
        if (model_.fixed_names_[i] == name && model_.fixed_[i].height > 0.0) return {PlaceKind::Fixed, i};
    for (std::size_t i = 0; i < model_.object_names_.size(); ++i)
        if (model_.object_names_[i] == name && model_.object_shape(i).height > 0.0)
            return {PlaceKind::Object, i};
    if (const auto i = index_of(world.lamps, name); i < world.lamps.size()) return {PlaceKind::Lamp, i};
    if (const auto i = index_of(world.speakers, name); i < world.speakers.size())
        return {PlaceKind::Speaker, i};
    if (const auto i = index_of(world.patches, name); i < world.patches.size()) return {PlaceKind::Patch, i};
    if (const auto i = index_of(model_.virtual_bodies_, name); i < model_.virtual_bodies_.size())
        return {PlaceKind::VirtualBody, i};
    if (const auto i = index_of(world.virtuals.lamps, name); i < world.virtuals.lamps.size())
        return {PlaceKind::VirtualLamp, i};
    if (const auto i = index_of(world.virtuals.boards, name); i < world.virtuals.boards.size())
        return {PlaceKind::VirtualBoard, i};
    return {};
}

std::vector<Scene::Listed> Scene::list() const {
    const World& world = model_.description_;
    std::vector<Listed> all;
    const auto add = [&](const char* kind, const std::string& name, Found what, bool lifted = false) {
        all.push_back({kind, name, pose_of(what), lifted});
    };
    for (std::size_t i = 0; i < world.robots.size(); ++i)
        add("robot", world.robots[i].name, {PlaceKind::Robot, i}, model_.robot(i).lifted());
    const auto kind_of = [](const Shape& shape) {
        return shape.kind == Shape::Kind::Box ? "box" : "cylinder";
    };
    for (std::size_t i = built_in_; i < model_.fixed_.size(); ++i)
        if (model_.fixed_[i].height > 0.0)
            add(walls_.contains(i) ? "wall" : kind_of(model_.fixed_[i]), model_.fixed_names_[i],
                {PlaceKind::Fixed, i});
    for (std::size_t i = 0; i < model_.object_names_.size(); ++i)
        if (model_.object_shape(i).height > 0.0)
            add(kind_of(model_.object_shape(i)), model_.object_names_[i], {PlaceKind::Object, i});
    for (std::size_t i = 0; i < world.lamps.size(); ++i)
        add("lamp", world.lamps[i].name, {PlaceKind::Lamp, i});
    for (std::size_t i = 0; i < world.speakers.size(); ++i)
        add("speaker", world.speakers[i].name, {PlaceKind::Speaker, i});
    for (std::size_t i = 0; i < world.patches.size(); ++i)
        add("floor_patch", world.patches[i].name, {PlaceKind::Patch, i});
    for (std::size_t i = 0; i < model_.virtual_bodies_.size(); ++i)
        add(model_.virtual_bodies_[i].kind, model_.virtual_bodies_[i].name, {PlaceKind::VirtualBody, i});
    for (std::size_t i = 0; i < world.virtuals.lamps.size(); ++i)
        add("virtual_lamp", world.virtuals.lamps[i].name, {PlaceKind::VirtualLamp, i});
    for (std::size_t i = 0; i < world.virtuals.boards.size(); ++i)
        add("virtual_board", world.virtuals.boards[i].name, {PlaceKind::VirtualBoard, i});
    return all;
}

std::string Scene::unknown(std::string_view name) const {
    if (is_booth(model_.description_, name))
        return fmt::format("'{}' is a TAM, which no event is about", name);
    const auto& trails = model_.description_.virtuals.pheromones;
    if (index_of(trails, name) < trails.size())
        return fmt::format("'{}' is a pheromone, which lies where it was laid", name);
    const auto all = list();
    std::vector<std::string_view> names;
    for (const Listed& one : all)
        names.emplace_back(one.name);
    const std::string meant = nearest_name(name, names);
    return fmt::format("there is no '{}' in this world{}", name,
                       meant.empty() ? "" : fmt::format(" (expected perhaps '{}')", meant));
}

Scene::Pose Scene::pose_of(Found what) const {
    const World& world = model_.description_;
    const auto plain = [](const auto& thing) { return Pose{thing.x, thing.y, 0.0}; };
    const auto placed = [](const Shape& shape) {
        return Pose{shape.x, shape.y, std::atan2(shape.sine, shape.cosine)};
    };
    const auto turned = [](const auto& thing) { return Pose{thing.x, thing.y, thing.heading}; };
    switch (what.kind) {
    case PlaceKind::Robot:
        return turned(model_.state(what.index));
    case PlaceKind::Fixed:
        return placed(model_.fixed_[what.index]);
    case PlaceKind::VirtualBody:
        return placed(model_.virtual_bodies_[what.index].shape);
    case PlaceKind::VirtualLamp:
        return plain(world.virtuals.lamps[what.index]);
    case PlaceKind::VirtualBoard:
        return turned(world.virtuals.boards[what.index]);
    case PlaceKind::Object:
        return turned(model_.object(what.index));
    case PlaceKind::Lamp:
        return plain(world.lamps[what.index]);
    case PlaceKind::Speaker:
        return plain(world.speakers[what.index]);
    case PlaceKind::Patch:
        return turned(world.patches[what.index]);
    case PlaceKind::Nothing:
        break;
    }
    return {};
}

void Scene::place(Found what, const Pose& pose, double vx, double vy) {
    World& world = model_.description_;
    const auto put_at = [&](auto& thing) {
        thing.x = pose.x;
        thing.y = pose.y;
    };
    switch (what.kind) {
    case PlaceKind::Robot:
        model_.dynamics_.place_robot(what.index, pose.x, pose.y, pose.heading);
        break;
    case PlaceKind::Fixed:
        model_.fixed_[what.index].place(pose.x, pose.y, pose.heading);
        model_.dynamics_.place_fixed(what.index, model_.fixed_[what.index]);
        model_.fixed_by_hand_.insert(what.index);
        break;
    case PlaceKind::Object:
        model_.dynamics_.place_object(what.index, pose.x, pose.y, pose.heading, vx, vy);
        break;
    case PlaceKind::Lamp:
        put_at(world.lamps[what.index]);
        break;
    case PlaceKind::Speaker:
        put_at(world.speakers[what.index]);
        break;
    case PlaceKind::VirtualBody:
        model_.virtual_bodies_[what.index].shape.place(pose.x, pose.y, pose.heading);
        model_.virtual_bodies_[what.index].by_hand = true;
        break;
    case PlaceKind::VirtualLamp:
        put_at(world.virtuals.lamps[what.index]);
        break;
    case PlaceKind::VirtualBoard:
        put_at(world.virtuals.boards[what.index]);
        world.virtuals.boards[what.index].heading = pose.heading;
        break;
    case PlaceKind::Patch:
        put_at(world.patches[what.index]);
        world.patches[what.index].heading = pose.heading;
        break;
    case PlaceKind::Nothing:
        return;
    }
    scene_changed();
}

Shape Scene::shape_of(Found what) const {
    Shape shape;
    if (what.kind == PlaceKind::Robot) {
        const auto& body = model_.robot(what.index).body();
        shape = circle_shape(0, 0, body.radius, body.height, body.reflectivity);
    } else if (what.kind == PlaceKind::Fixed) {
        return model_.fixed_[what.index];
    } else if (what.kind == PlaceKind::Object) {
        shape = model_.object_shape(what.index);
    }
    const Pose pose = pose_of(what);
    shape.place(pose.x, pose.y, pose.heading);
    return shape;
}

std::string Scene::obstacle(Found what, Pose pose) const {
    if (what.kind != PlaceKind::Robot && what.kind != PlaceKind::Fixed && what.kind != PlaceKind::Object)
        return {};
    Shape shape = shape_of(what);
    shape.place(pose.x, pose.y, pose.heading);
    return obstacle(shape, what, what.kind == PlaceKind::Fixed && walls_.contains(what.index));
}

std::string Scene::obstacle(const Shape& shape, Found itself, bool is_wall) const {
    const auto at = [&](const std::string& problem) {
        const auto tidy = [](double metres) { return std::round(metres * 1e4) / 1e4 + 0.0; };
        return fmt::format("({} m, {} m) {}", tidy(shape.x), tidy(shape.y), problem);
    };
    const auto meets = [&](PlaceKind kind, std::size_t index, const Shape& other) {
        return Found{kind, index} != itself && other.height > 0.0 && overlap(shape, other);
    };
    if (!inside(model_.description_.arena.corners, shape.x, shape.y)) return at("is outside the arena");
    for (std::size_t i = 0; i < model_.fixed_.size() && !is_wall; ++i)
        if (meets(PlaceKind::Fixed, i, model_.fixed_[i]))
            return at(i < arena_walls_ ? "is too close to the arena's wall: it would be in it"
                                       : fmt::format("is taken by '{}'", model_.fixed_names_[i]));
    for (std::size_t i = 0; i < model_.robot_count(); ++i)
        if (!model_.robot(i).lifted() && meets(PlaceKind::Robot, i, shape_of({PlaceKind::Robot, i})))
            return at(fmt::format("is taken by '{}'", model_.description_.robots[i].name));
    for (std::size_t i = 0; i < model_.object_names_.size(); ++i)
        if (model_.object_shape(i).height > 0.0 &&
            meets(PlaceKind::Object, i, shape_of({PlaceKind::Object, i})))
            return at(fmt::format("is taken by '{}'", model_.object_names_[i]));
    return {};
}

void Scene::set_lifted(std::size_t robot, bool lifted) {
    model_.robots_[robot].set_lifted(lifted);
    if (lifted)
        model_.dynamics_.hold_robot(robot);
    else
        model_.dynamics_.release_robot(robot);
    model_.moving_[robot].shape.height = lifted ? 0.0 : model_.robots_[robot].body().height;
    scene_changed();
}

void Scene::scene_changed() {
    model_.scene_changed_ = true;
    for (auto& robot : model_.robots_)
        robot.scene_changed(model_.description_);
}

}  // namespace puckloop::physics
