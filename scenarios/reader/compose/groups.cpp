#include "scenarios/reader/compose/groups.h"

#include "base/error.h"
#include "physics/description/robot_parameters.h"
#include "scenarios/reader/compose/placement.h"
#include "scenarios/reader/compose/spread.h"
#include "scenarios/tables/robot_tables.h"
#include "scenarios/tables/thing_tables.h"
#include "scenarios/tables/world_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>

namespace puckloop::scenarios {

namespace {

constexpr std::int64_t kMostOfGroup = 1000;
constexpr std::string_view kNumber = "{n}";
/// Keys of a group that are not its units'.
constexpr auto kGroupKeys =
    std::to_array<std::string_view>({"of", "count", "first", "name", "names", "place"});
/// Keys of a unit that its place decides.
constexpr auto kPlaceKeys = std::to_array<std::string_view>({"position", "centre", "heading"});

bool has(std::span<const std::string_view> keys, std::string_view key) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
}

std::string with_number(std::string text, std::int64_t number) {
    for (auto at = text.find(kNumber); at != std::string::npos; at = text.find(kNumber, at))
        text.replace(at, kNumber.size(), fmt::format("{}", number));
    return text;
}

TomlValue value_of(auto data, const TomlValue& from) {
    TomlValue value;
    value.data = std::move(data);
    value.line = from.line;
    value.source = from.source;
    return value;
}

/// Draws the values of one unit: each key by a stream of its own, so that another key changes none of them.
class CountedUnit {
  public:
    CountedUnit(const std::string& file, std::string name, std::int64_t number, std::uint64_t seed)
        : file_(file), name_(std::move(name)), number_(number), seed_(seed) {}

    const std::string& name() const { return name_; }
    std::int64_t number() const { return number_; }

    TomlValue draw(const TomlValue& value, const std::string& key) const {
        if (const auto* table = std::get_if<TomlTable>(&value.data)) {
            TomlTable own;
            for (const auto& [name, item] : *table)
                own.emplace_back(name, draw(item, key.empty() ? name : key + "." + name));
            return value_of(std::move(own), value);
        }
        if (const auto* array = std::get_if<TomlArray>(&value.data)) {
            TomlArray own;
            for (std::size_t i = 0; i < array->size(); ++i)
                own.push_back(draw((*array)[i], fmt::format("{}.{}", key, i)));
            return value_of(std::move(own), value);
        }
        const auto* text = std::get_if<std::string>(&value.data);
        if (!text) return value;
        RandomStream random(seed_, fmt::format("spread {} {}", name_, key));
        try {
            if (auto one = drawn(*text, random)) return value_of(std::move(one->data), value);
        } catch (const SpreadError& error) {
            throw InputError(value.source ? *value.source : file_, fmt::format("line {}", value.line),
                             fmt::format("{}: {}", key, error.problem), error.expected);
        }
        return value_of(with_number(*text, number_), value);
    }

  private:
    const std::string& file_;
    std::string name_;
    std::int64_t number_;
    std::uint64_t seed_;
};

class Group {
  public:
    Group(const std::string& file, const TomlValue& table, Scenario& scenario)
        : file_(file), table_(table), scenario_(scenario), reader_(file, "group", table) {
        of_ = reader_.choice("of", "robot", {"robot", "box", "cylinder", "lamp"});
        names_ = reader_.texts("names");
        if (!names_.empty())
            for (const char* other : {"name", "first", "count"})
                if (reader_.has(other))
                    reader_.fail(other, "the units have names of their own", "names alone");
        name_ = reader_.text("name", names_.empty() ? of_ : names_.front());
        if (name_.find(kNumber) == std::string::npos) name_ += kNumber;
        for (const std::string_view key : kPlaceKeys)
            if (reader_.has(key))
                reader_.fail(key, fmt::format("the units of a group have no common {}", key),
                             "[group.place]");
    }

    void add() {
        Placement placement(file_, "group " + name_, reader_.table("place"), scenario_.world.arena,
                            scenario_.seed);
        const std::int64_t count = count_of(placement);
        const std::int64_t first = reader_.integer("first", 0, 0, 1'000'000);
        placement.set_units(static_cast<std::size_t>(count));
        Occupied occupied(scenario_.world);
        for (std::int64_t i = 0; i < count; ++i) {
            const std::string name =
                names_.empty() ? with_number(name_, first + i) : names_[static_cast<std::size_t>(i)];
            const CountedUnit unit(file_, name, first + i, scenario_.seed);
            TomlTable described;
            for (const auto& [key, value] : std::get<TomlTable>(table_.data))
                if (!has(kGroupKeys, key)) described.emplace_back(key, unit.draw(value, key));
            place(unit, static_cast<std::size_t>(i), static_cast<std::size_t>(count), described, placement,
                  occupied);
        }
    }

  private:
    std::int64_t count_of(const Placement& placement) {
        const auto places = placement.count();
        if (!names_.empty()) {
            const auto count = static_cast<std::int64_t>(names_.size());
            if (count > kMostOfGroup) reader_.fail("names", "there are too many names", "at most 1000");
            if (places && names_.size() != *places)
                reader_.fail("names", fmt::format("{} names for {} positions", count, *places), "as many");
            return count;
        }
        const std::int64_t most = places ? static_cast<std::int64_t>(*places) : kMostOfGroup;
        const std::int64_t count = reader_.integer("count", places ? most : 0, 1, most);
        if (count == 0) reader_.fail_missing("count", "count = 20");
        return count;
    }

    void place(const CountedUnit& unit, std::size_t index, std::size_t count, const TomlTable& described,
               Placement& placement, Occupied& occupied) {
        std::string obstacle;
        const std::size_t trials = placement.is_drawn() ? placement.max_trials() : 1;
        for (std::size_t trial = 0; trial < trials; ++trial) {
            const UnitPose pose = placement.propose(index);
            TomlTable whole = described;
            add_pose(pose, unit, whole);
            const std::optional<physics::Shape> shape = shape_of_unit(whole, pose);
            obstacle = shape ? occupied.obstacle(*shape, placement.gap()) : "";
            if (!obstacle.empty()) continue;
            if (shape) occupied.add(*shape, unit.name());
            read(whole);
            return;
        }
        const std::string where =
            placement.line() > 0 ? fmt::format("line {}", placement.line()) : place_of(table_);
        throw InputError(
            table_.source ? *table_.source : file_, where,
            placement.is_drawn()
                ? fmt::format("{}, unit {} of {}, finds no free place in {} trials (of the last: {})",
                              unit.name(), index + 1, count, trials, obstacle)
                : fmt::format("{}, unit {} of {}, has no free place: {}", unit.name(), index + 1, count,
                              obstacle),
            placement.is_drawn() ? "fewer units, more room or more max_trials" : "places that are free");
    }

    void add_pose(const UnitPose& pose, const CountedUnit& unit, TomlTable& whole) const {
        const auto length = [&](double metres) { return value_of(fmt::format("{:.17g} m", metres), table_); };
        whole.emplace_back("name", value_of(unit.name(), table_));
        whole.emplace_back(of_ == "robot" ? "position" : "centre",
                           value_of(TomlArray{length(pose.x), length(pose.y)}, table_));
        if (of_ == "robot" || of_ == "box")
            whole.emplace_back("heading", value_of(fmt::format("{:.17g} rad", pose.heading), table_));
    }

    /// What the unit takes of the floor; nothing of a lamp.
    std::optional<physics::Shape> shape_of_unit(const TomlTable& whole, const UnitPose& pose) const {
        const TomlValue table = value_of(whole, table_);
        Reader reader(file_, of_, table);
        if (of_ == "box") {
            physics::Box box;
            read_box(reader, box);
            return shape_of(box);
        }
        if (of_ == "cylinder") {
            physics::Cylinder cylinder;
            read_cylinder(reader, cylinder);
            return shape_of(cylinder);
        }
        if (of_ == "lamp") return std::nullopt;
        physics::Robot robot;
        if (const TomlValue* parameters = reader.table("parameters"))
            robot.parameters = read_parameters(file_, "group.parameters", *parameters);
        const auto& body = parameters_of(scenario_.world, robot).robot;
        return physics::circle_shape(pose.x, pose.y, body.radius, body.height, 1.0);
    }

    void read(const TomlTable& whole) {
        const TomlValue table = value_of(whole, table_);
        if (of_ == "robot") {
            read_robot(file_, table, scenario_);
            return;
        }
        Reader reader(file_, of_, table);
        const auto add_to = [&](auto& list, auto read_thing) {
            auto& thing = list.emplace_back();
            thing.name = reader.text("name");
            thing.place = place_of(table);
            read_thing(reader, thing);
            reader.finish();
        };
        if (of_ == "box") add_to(scenario_.world.boxes, read_box);
        if (of_ == "cylinder") add_to(scenario_.world.cylinders, read_cylinder);
        if (of_ == "lamp") add_to(scenario_.world.lamps, read_lamp);
    }

    const std::string& file_;
    const TomlValue& table_;
    Scenario& scenario_;
    Reader reader_;
    std::string of_, name_;
    std::vector<std::string> names_;
};

}  // namespace

void read_group(const std::string& file, const TomlValue& table, Scenario& scenario) {
    Group(file, table, scenario).add();
}

}  // namespace puckloop::scenarios
