#pragma once
// Where the units of a group are: the table [group.place].

#include "base/random.h"
#include "physics/description/plan.h"
#include "scenarios/values/reader.h"

#include <optional>
#include <string>
#include <vector>

namespace puckloop::scenarios {

struct UnitPose {
    double x = 0.0, y = 0.0, heading = 0.0;  ///< m, m, rad
};

/// Proposes poses for the units of one group.
class Placement {
  public:
    /// `table` null: drawn in the arena. Throws InputError with file and line.
    Placement(const std::string& file, const std::string& group, const TomlValue* table,
              const physics::Arena& arena, std::uint64_t seed);

    /// Number of units that a list or a grid has; none for other kinds.
    std::optional<std::size_t> count() const;
    /// Of unit `index`; where `is_drawn()`, another one at each call.
    UnitPose propose(std::size_t index);
    bool is_drawn() const;
    /// Proposals for one unit before it is given up.
    std::size_t max_trials() const { return max_trials_; }
    /// Least clearance to everything else, m.
    double gap() const { return gap_; }
    int line() const { return line_; }

  private:
    enum class Kind { Arena, Disc, Rectangle, Normal, Grid, Ring, List };
    void read(Reader& reader);
    void read_list(Reader& reader);
    void read_heading(Reader& reader);
    double heading_of(std::size_t index);
    UnitPose draw();

    physics::Arena arena_;
    RandomStream random_;
    std::string file_, group_;
    Kind kind_ = Kind::Arena;
    physics::Point centre_{};
    double radius_ = 0.0, start_ = 0.0;
    physics::Point size_{};  // rectangle; deviations; distances of a grid
    std::size_t columns_ = 0, rows_ = 0, ring_ = 0;
    std::vector<UnitPose> list_;
    enum class Heading { Drawn, Fixed, Spread, Outward, Inward };
    Heading heading_ = Heading::Drawn;
    double fixed_heading_ = 0.0;
    std::string heading_spread_;
    std::size_t max_trials_ = 1000;
    double gap_ = 0.0;
    int line_ = 0;

  public:
    /// For a ring: among so many units it is divided.
    void set_units(std::size_t units) { ring_ = units; }
};

/// What is where already, and whether a unit fits besides.
class Occupied {
  public:
    /// Everything in the world as it is described up to now.
    explicit Occupied(const physics::World& world);

    /// Why there is no room for `shape` with a clearance of `gap` metres; empty: there is.
    std::string obstacle(const physics::Shape& shape, double gap) const;
    void add(const physics::Shape& shape, const std::string& name) { things_.push_back({shape, name}); }

  private:
    struct Thing {
        physics::Shape shape;
        std::string name;
    };
    physics::Arena arena_;
    std::vector<Thing> things_;
};

}  // namespace puckloop::scenarios
