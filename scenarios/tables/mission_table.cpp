#include "scenarios/tables/mission_table.h"

#include "base/error.h"
#include "scenarios/values/region_keys.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::scenarios {

namespace {

missions::Region read_region_of(const std::string& file, const std::string& where, const TomlValue& table) {
    Reader reader(file, where, table);
    const missions::Region region = read_region(reader);
    reader.finish();
    return region;
}

/// `value` and `period` in s.
void check_multiple(Reader& reader, const char* key, double value, double period) {
    const double periods = value / period;
    if (std::abs(periods - std::round(periods)) > 1e-6)
        reader.fail(key, fmt::format("{} is no multiple of {:g} s, the period of the recording", key, period),
                    fmt::format("another {}, or another record_every of [run]", key));
}

void refuse_unless(Reader& reader, const char* key, bool used, const std::string& kind) {
    if (reader.has(key) && !used)
        reader.fail(key, fmt::format("{} has no {}", kind, key), "the keys in docs/swarm.md");
}

missions::Region read_needed(Reader& reader, const char* key) {
    const TomlValue* table = reader.table(key);
    if (!table) reader.fail_missing(key, fmt::format("[mission.{}] with shape and size or radius", key));
    return read_region_of(reader.file(), fmt::format("mission.{}", key), *table);
}

/// A table that counts; its kind has been read.
missions::Mission read_counted(Reader& reader, const std::string& kind, double period) {
    missions::Mission mission;
    mission.name = kind;
    mission.kind = mission.name == "foraging"           ? missions::Kind::Foraging
                   : mission.name == "coverage"         ? missions::Kind::Coverage
                   : mission.name == "grid_exploration" ? missions::Kind::GridExploration
                                                        : missions::Kind::Aggregation;
    mission.begin = reader.quantity("begin", Dimension::Time, mission.begin);
    if (!(mission.begin >= 0.0 && mission.begin <= 1e6))
        reader.fail("begin", "begin is out of range", "0 s to 1e6 s");
    mission.step = reader.quantity("step", Dimension::Time, mission.step);
    if (!(mission.step > 0.0 && mission.step <= 1e6))
        reader.fail("step", "step is out of range", "more than 0 s, at most 1e6 s");
    check_multiple(reader, "step", mission.step, period);
    check_multiple(reader, "begin", mission.begin, period);
    const bool coverage = mission.kind == missions::Kind::Coverage,
               grid = mission.kind == missions::Kind::GridExploration,
               foraging = mission.kind == missions::Kind::Foraging,
               aggregation = mission.kind == missions::Kind::Aggregation;
    refuse_unless(reader, "spot", !grid, mission.name);
    refuse_unless(reader, "nest", foraging, mission.name);
    refuse_unless(reader, "area", coverage || grid, mission.name);
    refuse_unless(reader, "cells", grid, mission.name);
    refuse_unless(reader, "at_end", aggregation, mission.name);
    for (const TomlValue* spot : reader.tables("spot"))
        mission.spots.push_back(read_region_of(reader.file(), "mission.spot", *spot));
    if ((aggregation || foraging) && mission.spots.empty())
        reader.fail_missing("spot", "[[mission.spot]] with shape and size or radius");
    if (foraging) mission.nest = read_needed(reader, "nest");
    if (coverage || grid) mission.area = read_needed(reader, "area");
    if (grid) {
        mission.cells = static_cast<std::size_t>(reader.integer("cells", 10, 1, 1000));
        if (mission.area.disc) reader.fail("area", "a grid of cells is a rectangle", "shape = \"rectangle\"");
    }
    if (aggregation) mission.at_end = reader.flag("at_end", false);
    return mission;
}

MissionCommand read_command(Reader& reader) {
    MissionCommand mission;
    mission.command = reader.texts("program");
    if (mission.command.empty() || mission.command.front().empty())
        reader.fail_missing("program", "program = [\"./mission.py\"]");
    if (mission.command.front().find('/') != std::string::npos)
        mission.command.front() = (reader.folder() / mission.command.front()).lexically_normal().string();
    mission.better = reader.choice("better", mission.better, {"more", "less"});
    mission.timeout = reader.quantity("timeout", Dimension::Time, mission.timeout);
    if (!(mission.timeout >= 0.001 && mission.timeout <= 1e6))
        reader.fail("timeout", "timeout is out of range", "1 ms to 1e6 s, of wall time");
    return mission;
}

}  // namespace

void read_mission(Reader& top, double period, Scenario& scenario) {
    const TomlValue* table = top.table("mission");
    if (!table) return;
    Reader reader(top.file(), "mission", *table);
    const std::string kind = reader.choice(
        "kind", "", {"aggregation", "shelter", "foraging", "coverage", "grid_exploration", "program"});
    if (kind == "program") {
        scenario.mission_program = read_command(reader);
        scenario.mission_program->file = top.file();
        scenario.mission_program->place = place_of(*table);
        scenario.mission.reset();
    } else {
        scenario.mission = read_counted(reader, kind, period);
        scenario.mission_program.reset();
    }
    reader.finish();
}

void read_mission_of(const std::filesystem::path& file, double period, Scenario& scenario) {
    const TomlValue root = read_toml(file);
    Reader top(file.string(), "", root);
    if (!top.has("mission"))
        throw InputError(file.string(), "", "there is no [mission]", "[mission] with its kind");
    read_mission(top, period, scenario);
}

}  // namespace puckloop::scenarios
