#pragma once
// The hands of whoever is beside the arena: carries out actions on a WorldModel between two of its steps.
// What cannot be done is refused with a reason and changes nothing.

#include "physics/events/event.h"
#include "physics/world/world_model.h"

#include <map>
#include <set>

namespace puckloop::physics {

/// A thing by its name: where to find it.
struct Found {
    enum class Kind : std::uint8_t {
        Nothing,
        Robot,
        Fixed,
        Object,
        Lamp,
        Speaker,
        Patch,
        VirtualBody,
        VirtualLamp,
        VirtualBoard
    };
    Kind kind = Kind::Nothing;
    std::size_t index = 0;  ///< among the model's robots, fixed things, objects, lamps, ...

    explicit operator bool() const { return kind != Kind::Nothing; }
    friend bool operator==(const Found&, const Found&) = default;
};

class Scene {
  public:
    /// `model` must outlive it.
    explicit Scene(WorldModel& model);

    /// Carries out what happens in the world itself: not Select, Reset, Remote. A Move that glides is begun,
    /// glide() goes on with it. Returns why it is refused, or nothing.
    std::string apply(const Action& action);
    /// Once a step, before apply(): one step on with what glides.
    void glide();

    Found find(std::string_view name) const;
    /// "there is no 'cam' (expected perhaps 'can')"
    std::string unknown(std::string_view name) const;
    const WorldModel& model() const { return model_; }
    /// Of a robot or body in plan.
    Shape shape_of(Found what) const;

    struct Pose {
        double x = 0.0, y = 0.0, heading = 0.0;
    };
    struct Listed {
        std::string kind, name;
        Pose pose;
        bool lifted;  ///< a robot
    };
    /// What is where now.
    std::vector<Listed> list() const;

  private:
    struct Glide {
        std::string name;
        Pose from, to;
        std::uint64_t steps = 1, done = 0;
        bool stays_lifted = false;
    };

    std::string move(const Action& action, Found what);
    std::string add(const Action& action);
    std::string remove(const Action& action, Found what);
    std::string lift(const Action& action, Found what);
    std::string put(const Action& action, Found what);
    std::string set(const Action& action, Found what);
    std::string set_room(const Action& action);
    std::string switch_over(const Action& action, Found what);
    std::string unset(const Action& action, Found what);
    std::string tune(const Action& action, Found what);
    template <class Thing>
    std::string add_body(const Thing& thing, double heading);
    void add_fixed(const Shape& shape, const std::string& name);

    // Places (scene_places.cpp).
    Pose pose_of(Found what) const;
    void place(Found what, const Pose& pose, double vx = 0.0, double vy = 0.0);
    /// Why a body cannot be at `pose`, or nothing.
    std::string obstacle(Found what, Pose pose) const;
    std::string obstacle(const Shape& shape, Found itself, bool is_wall) const;
    void set_lifted(std::size_t robot, bool lifted);
    void scene_changed();
    void stop_gliding(std::string_view name);

    WorldModel& model_;
    std::size_t arena_walls_, built_in_;    // among the fixed things: the first so many
    std::set<std::size_t> walls_;           // among the fixed things: these may meet each other
    std::map<std::string, double> was_on_;  // what is switched off: how bright or loud it was
    std::vector<Glide> glides_;
};

}  // namespace puckloop::physics
