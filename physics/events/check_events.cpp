// Can what is planned happen? Every refusal names the event, and where the user wrote it.

#include "base/error.h"
#include "base/text/suggest.h"
#include "physics/description/booth.h"
#include "physics/description/plan.h"
#include "physics/description/robot_parameters.h"
#include "physics/events/new_thing.h"
#include "physics/robot/tuning.h"
#include "protocols/infrared/rc5.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace puckloop::physics {

namespace {

constexpr double kFarthestOfEvents = 1000.0;  // m, as in check()
constexpr double kLongestOfEvent = 3600.0;    // s: a glide, a key held
constexpr int kLastPosition = 15;

struct Range {
    const char* property;
    double low, high;
};
constexpr Range kProperties[] = {{"grey", 0, 1},    {"ambient", 0, 100},     {"intensity", 0, 100},
                                 {"level", 0, 1e5}, {"reflectivity", 0, 10}, {"charge", 0, 1},
                                 {"ground", 0, 1}};

std::string out_of(const char* what, double value, double low, double high) {
    if (value >= low && value <= high) return {};
    return fmt::format("{} = {} is out of range (expected {} to {})", what, value, low, high);
}

std::string first_of(std::initializer_list<std::string> problems) {
    for (const std::string& problem : problems)
        if (!problem.empty()) return problem;
    return {};
}

/// What is known before the run: names with their kinds, and what will not move away.
class EventChecker {
  public:
    EventChecker(const EventPlan& plan, const World& world) : plan_(plan), world_(world) { gather(); }

    void run() {
        for (const Event& event : plan_.events)
            check(event);
    }

  private:
    [[noreturn]] static void fail(const Event& event, const std::string& problem) {
        throw InputError(event.file, event.place, event.name + ": " + problem);
    }

    void gather() {
        const auto add = [this](const auto& thing, const char* kind) { kinds_[thing.name] = kind; };
        for_each_thing(world_, add);
        for (const Robot& robot : world_.robots)
            add(robot, "robot");
        for (const Event& event : plan_.events) {
            events_.insert(event.name);
            const Action& action = event.action;
            if (action.verb == Verb::Add)
                for_each_thing(action.thing, add);
            else if (action.verb != Verb::Send)
                touched_.insert(action.object);
        }
    }

    std::string kind_of(const Event& event, const std::string& name) const {
        if (const auto found = kinds_.find(name); found != kinds_.end()) return found->second;
        if (is_booth(world_, name)) fail(event, fmt::format("'{}' is a TAM, which no event is about", name));
        std::vector<std::string_view> names;
        for (const auto& [known, kind] : kinds_)
            names.emplace_back(known);
        const std::string meant = nearest_name(name, names);
        fail(event, fmt::format("there is no '{}' in this world{}", name,
                                meant.empty() ? "" : fmt::format(" (expected perhaps '{}')", meant)));
    }

    void need_robot(const Event& event, const std::string& name) const {
        if (const std::string kind = kind_of(event, name); kind != "robot")
            fail(event, fmt::format("'{}' is a {} (expected a robot)", name, kind));
    }

    void need_no_trail(const Event& event, const char* why) const {
        if (kind_of(event, event.action.object) == "pheromone")
            fail(event, fmt::format("'{}' is a pheromone: {}", event.action.object, why));
    }

    void check(const Event& event) const {
        const Action& action = event.action;
        if (std::string problem = problem_of(action); !problem.empty()) fail(event, problem);
        if (event.when) check(event, *event.when);
        switch (action.verb) {
        case Verb::Send:
            if (std::string problem = problem_of_computer(plan_, action.object); !problem.empty())
                fail(event, problem);
            return;
        case Verb::Add:
            check_new(event);
            return;
        case Verb::Remote:
            if (action.object == kEveryRobot) return;
            [[fallthrough]];
        case Verb::Lift:
        case Verb::Unset:
        case Verb::Tune:
        case Verb::Put:
        case Verb::Select:
        case Verb::Reset:
            need_robot(event, action.object);
            break;
        case Verb::SwitchOff:
        case Verb::SwitchOn:
            if (const auto kind = kind_of(event, action.object);
                kind != "lamp" && kind != "virtual_lamp" && kind != "speaker")
                fail(event, fmt::format("'{}' is a {} (expected a lamp or a speaker)", action.object, kind));
            break;
        case Verb::Set:
            check_property(event);
            return;
        case Verb::Remove:
            need_no_trail(event, "it goes by itself");
            if (kind_of(event, action.object) == "virtual_board")
                fail(event, fmt::format("'{}' is a virtual board, which stays in the run", action.object));
            if (kind_of(event, action.object) == "robot")
                fail(event, fmt::format("'{}' is a robot, which stays in the run (expected lift, or a thing)",
                                        action.object));
            return;
        case Verb::Move:
            need_no_trail(event, "it lies where it was laid");
            break;
        }
        check_place(event);
    }

    void check(const Event& event, const Condition& when) const {
        if (when.kind == Condition::Kind::After) {
            if (when.other == event.name || !events_.contains(when.other))
                fail(event, fmt::format("after: there is no other event '{}'", when.other));
            return;
        }
        need_robot(event, when.robot);
        if (when.kind != Condition::Kind::Near) return;
        const std::string kind = kind_of(event, when.other);
        if (when.other == when.robot) fail(event, fmt::format("near: '{}' is itself", when.other));
        if (kind != "robot" && kind != "box" && kind != "cylinder" && kind != "wall")
            fail(event, fmt::format("near: '{}' is a {} (expected a robot, box, cylinder or wall)",
                                    when.other, kind));
    }

    void check_property(const Event& event) const {
        const Action& action = event.action;
        const auto has = [&](std::string_view kind) {
            const std::string& p = action.property;
            if (kind == kFloor || kind == "floor_patch") return p == "grey";
            if (kind == kRoomLight) return p == "ambient";
            if (kind == "lamp" || kind == "virtual_lamp") return p == "intensity";
            if (kind == "pheromone" || kind == "virtual_board") return false;
            if (kind == "speaker") return p == "level";
            if (kind == "robot") return p == "charge" || p == "ground";
            return p == "reflectivity";
        };
        const bool room =
            !kinds_.contains(action.object) && (action.object == kFloor || action.object == kRoomLight);
        const std::string kind = room ? action.object : kind_of(event, action.object);
        if (!has(kind))
            fail(event, fmt::format("'{}', a {}, has no {}", action.object, kind, action.property));
    }

    /// Sizes and values of a new thing: as of one that is there from the start.
    void check_new(const Event& event) const {
        const NewThing& thing = event.action.thing;
        World world = world_of(thing, world_.arena);
        world.file = event.file;
        check_things(world);
        check_who_senses(world.virtuals, world_.robots, event.file);
        for (const Box& box : thing.boxes)
            check_free(event, shape_of(box));
        for (const Cylinder& cylinder : thing.cylinders)
            check_free(event, shape_of(cylinder));
        for (const Wall& wall : thing.walls)
            check_inside(event, shape_of(wall));
    }

    void check_place(const Event& event) const {
        const Action& action = event.action;
        if (!action.to || action.relative) return;
        const auto move = [&](Shape shape, double heading) {
            shape.place(action.to->x, action.to->y, action.heading.value_or(heading));
            if (kinds_.at(action.object) == "wall")
                check_inside(event, shape);
            else
                check_free(event, shape);
        };
        for (const Wall& wall : world_.walls)
            if (wall.name == action.object)
                move(shape_of(wall), std::atan2(wall.to.y - wall.from.y, wall.to.x - wall.from.x));
        for (const Box& box : world_.boxes)
            if (box.name == action.object) move(shape_of(box), box.heading);
        for (const Cylinder& cylinder : world_.cylinders)
            if (cylinder.name == action.object) move(shape_of(cylinder), 0.0);
        for (const Robot& robot : world_.robots) {
            if (robot.name != action.object) continue;
            const BodyParameters body = parameters_of(world_, robot).robot;
            move(circle_shape(0, 0, body.radius, body.height, body.reflectivity), 0.0);
        }
    }

    void check_inside(const Event& event, const Shape& shape) const {
        if (!inside(world_.arena.corners, shape.x, shape.y))
            fail(event, fmt::format("({:.4g} m, {:.4g} m) is outside the arena", shape.x, shape.y));
    }

    /// Free of the arena's walls and of everything that no event touches.
    void check_free(const Event& event, const Shape& shape) const {
        check_inside(event, shape);
        for (const Shape& wall : arena_walls(world_.arena))
            if (overlap(shape, wall))
                fail(event, fmt::format("({:.4g} m, {:.4g} m) is too close to the arena's wall: it would be "
                                        "in it",
                                        shape.x, shape.y));
        const auto stays = [&](const auto& thing) {
            if (thing.name == event.action.object || touched_.contains(thing.name)) return;
            if (overlap(shape, shape_of(thing)))
                fail(event,
                     fmt::format("({:.4g} m, {:.4g} m) is taken by '{}'", shape.x, shape.y, thing.name));
        };
        for (const Wall& wall : world_.walls)
            stays(wall);
        for (const Box& box : world_.boxes)
            if (!box.movable) stays(box);
        for (const Cylinder& cylinder : world_.cylinders)
            if (!cylinder.movable) stays(cylinder);
    }

    const EventPlan& plan_;
    const World& world_;
    std::map<std::string, std::string> kinds_;
    std::set<std::string> events_, touched_;
};

}  // namespace

std::string problem_of(const Action& action) {
    if (action.verb < Verb::Move || action.verb > Verb::Send) return "unknown action";
    const auto& to = action.to;
    if (std::string problem =
            first_of({to ? out_of("x", to->x, -kFarthestOfEvents, kFarthestOfEvents) : "",
                      to ? out_of("y", to->y, -kFarthestOfEvents, kFarthestOfEvents) : "",
                      out_of("heading", action.heading.value_or(0), -kFarthestOfEvents, kFarthestOfEvents),
                      out_of("over", action.over, 0, kLongestOfEvent),
                      out_of("hold", action.hold, 0, kLongestOfEvent)});
        !problem.empty())
        return problem;
    switch (action.verb) {
    case Verb::Move:
        return to || action.heading ? "" : "no place to move to (expected 'to', 'by' or 'heading')";
    case Verb::Add: {
        int things = 0;
        bool named = true;
        for_each_thing(action.thing, [&](const auto& thing, const char*) {
            ++things;
            named = named && thing.name == action.object;
        });
        return things == 1 && named ? "" : "nothing to add";
    }
    case Verb::Set:
        for (const Range& range : kProperties)
            if (action.property == range.property)
                return out_of(range.property, action.value, range.low, range.high);
        return fmt::format("'{}' cannot be set", action.property);
    case Verb::Tune:
        return problem_of_tuning(action.property, action.value);
    case Verb::Send:
        if (action.text.empty() || action.text.size() > kLongestText)
            return fmt::format("a text of {} octets (expected 1 to {})", action.text.size(), kLongestText);
        return out_of("port", action.number, 1, 65'535);
    case Verb::Select:
        return out_of("position", action.number, 0, kLastPosition);
    case Verb::Remote:
        return first_of({out_of("key", action.number, 0, protocols::kRc5LastCommand),
                         out_of("address", action.address, 0, protocols::kRc5LastAddress)});
    default:
        return {};
    }
}

std::string problem_of_computer(const EventPlan& plan, std::string_view name) {
    std::string known;
    for (const Computer& one : plan.computers) {
        if (one.name == name) return {};
        known += (known.empty() ? "" : ", ") + one.name;
    }
    if (known.empty())
        return fmt::format("there is no computer on a network that could be '{}' (expected [network], and a "
                           "Linux board or a [[host]])",
                           name);
    return fmt::format("there is no '{}' on the network (expected {})", name, known);
}

bool EventPlan::may_send() const {
    const bool planned = std::any_of(events.begin(), events.end(),
                                     [](const Event& event) { return event.action.verb == Verb::Send; });
    return !computers.empty() && (live || mission || planned);
}

void check_events(const EventPlan& plan, const World& world) {
    EventChecker(plan, world).run();
}

}  // namespace puckloop::physics
