#include "scenarios/reader/events/event_tables.h"

#include "base/error.h"
#include "scenarios/reader/events/action_forms.h"
#include "scenarios/reader/events/command_text.h"
#include "scenarios/tables/thing_tables.h"
#include "scenarios/tables/world_tables.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace puckloop::scenarios {

namespace {

using physics::Action;
using physics::Condition;
using physics::Event;
using physics::Verb;

constexpr double kLatestEvent = 86'400.0 * 30;  // s, as a run
constexpr std::int64_t kMostTimes = 1'000'000;
constexpr int kManagerPort = 7701;  // of puckloop-netmanager --control

/// To the microsecond.
cosim::Time read_time(Reader& reader, std::string_view key, double seconds) {
    if (!(seconds >= 0 && seconds <= kLatestEvent))
        reader.fail(key, fmt::format("{} is out of range", key), "0 s to 720 h");
    return std::llround(seconds * 1e6) * cosim::kMicrosecond;
}

physics::Point read_point(Reader& reader, std::string_view key) {
    const auto point = reader.quantities(key, Dimension::Length, 2);
    return {point[0], point[1]};
}

void read_pose(Reader& reader, Action& action) {
    if (reader.has("to")) action.to = read_point(reader, "to");
    action.heading = reader.optional_quantity("heading", Dimension::Angle);
}

void read_move(Reader& reader, Action& action) {
    read_pose(reader, action);
    if (reader.has("by")) {
        if (action.to) reader.fail("by", "both 'to' and 'by'", "one of them");
        action.to = read_point(reader, "by");
        action.relative = true;
    }
    action.over = reader.quantity("over", Dimension::Time, 0.0);
    if (!action.to && !action.heading) reader.fail("move", "no place to move to", "'to', 'by' or 'heading'");
}

void read_new_thing(Reader& reader, Action& action, int line) {
    std::vector<std::string> kinds;
    for (const ThingForm& form : thing_forms())
        kinds.emplace_back(form.kind);
    const std::string kind = reader.choice("add", "", kinds);
    action.object = reader.text("name");
    const auto read = [&](auto& list, auto read_thing) {
        auto& thing = list.emplace_back();
        thing.name = action.object;
        thing.place = line > 0 ? fmt::format("line {}", line) : "";
        read_thing(reader, thing);
    };
    physics::NewThing& things = action.thing;
    if (kind == "wall") read(things.walls, read_wall);
    if (kind == "box") read(things.boxes, read_box);
    if (kind == "cylinder") read(things.cylinders, read_cylinder);
    if (kind == "lamp") read(things.lamps, read_lamp);
    if (kind == "speaker") read(things.speakers, read_speaker);
    if (kind == "floor_patch") read(things.patches, read_patch);
    physics::VirtualThings& virtuals = things.virtuals;
    if (kind == "virtual_wall") read(virtuals.walls, read_virtual_wall);
    if (kind == "virtual_box") read(virtuals.boxes, read_virtual_box);
    if (kind == "virtual_cylinder") read(virtuals.cylinders, read_virtual_cylinder);
    if (kind == "virtual_lamp") read(virtuals.lamps, read_virtual_lamp);
}

void read_property(Reader& reader, Action& action) {
    std::string names;
    for (const ActionKey& key : keys_of("set", "")) {
        names += (names.empty() ? "" : ", ") + std::string(key.name);
        if (!reader.has(key.name)) continue;
        if (!action.property.empty())
            reader.fail(key.name, fmt::format("both '{}' and '{}'", action.property, key.name),
                        "one event for each");
        action.property = key.name;
        action.value = reader.quantity(key.name, key.name == "level" ? Dimension::Number : Dimension::Ratio);
    }
    if (action.property.empty()) reader.fail("set", "nothing to set", "one of " + names);
}

constexpr int kNoNumber = std::numeric_limits<int>::min();

int read_number(Reader& reader, std::string_view key, int last) {
    if (!reader.has(key)) reader.fail(key, fmt::format("'{}' is missing", key));
    return static_cast<int>(reader.integer(key, kNoNumber, 0, last));
}

Action read_action(Reader& reader, const TomlValue& table, int line) {
    const std::string verb = verb_of(table);
    Action action;
    if (verb.empty()) {
        std::string verbs;
        bool any = false;
        for (const ActionForm& form : action_forms()) {
            verbs += (verbs.empty() ? "" : ", ") + std::string(form.verb);
            any = reader.has(form.verb) || any;
        }
        if (!any) reader.finish();  // a misspelt one is named
        reader.fail("", any ? "more than one action" : "no action", "one of " + verbs);
    }
    action.object = reader.text(verb);
    for (std::size_t i = 0; i < action_forms().size(); ++i)
        if (action_forms()[i].verb == verb) action.verb = static_cast<Verb>(i);
    switch (action.verb) {
    case Verb::Move:
        read_move(reader, action);
        break;
    case Verb::Add:
        read_new_thing(reader, action, line);
        break;
    case Verb::Put:
        read_pose(reader, action);
        break;
    case Verb::Set:
        read_property(reader, action);
        break;
    case Verb::Select:
        action.number = read_number(reader, "position", 15);
        break;
    case Verb::Remote:
        action.number = read_number(reader, "key", 63);
        action.address = static_cast<int>(reader.integer("address", 0, 0, 31));
        action.hold = reader.quantity("hold", Dimension::Time, 0.0);
        break;
    case Verb::Tune:
        action.property = reader.text("parameter");
        action.value = reader.quantity("value", dimension_of_parameter(action.property));
        break;
    case Verb::Send:
        action.text = reader.text("text");
        action.number = static_cast<int>(reader.integer("port", kManagerPort, 1, 65'535));
        break;
    case Verb::Remove:
    case Verb::Lift:
    case Verb::SwitchOff:
    case Verb::SwitchOn:
    case Verb::Reset:
    case Verb::Unset:
        break;
    }
    action.command = command_text(table);
    action.toml = toml_text(table);
    return action;
}

Condition read_condition(const std::string& file, const std::string& where, const TomlValue& table) {
    Reader reader(file, where + ": when", table);
    Condition when;
    const std::vector<std::string> kinds{"near", "enters", "travels", "led", "wheels", "after"};
    int given = 0;
    for (const std::string& kind : kinds)
        given += reader.has(kind) ? 1 : 0;
    if (given != 1) {
        reader.has("robot");
        for (const char* key : {"within", "radius", "size", "on"})
            reader.has(key);
        if (given == 0) reader.finish();
        reader.fail("", given == 0 ? "no condition" : "more than one condition",
                    "one of near, enters, travels, led, wheels, after");
    }
    if (reader.has("after")) {
        when.kind = Condition::Kind::After;
        when.other = reader.text("after");
        reader.finish();
        return when;
    }
    when.robot = reader.text("robot");
    const auto length = [&](std::string_view key, double least) {
        const double value = reader.quantity(key, Dimension::Length);
        if (!(value >= least && value <= 1e6)) reader.fail(key, fmt::format("{} is out of range", key));
        return value;
    };
    constexpr double kShortest = 1e-6;  // m
    if (reader.has("near")) {
        when.kind = Condition::Kind::Near;
        when.other = reader.text("near");
        when.distance = length("within", 0.0);
    } else if (reader.has("enters")) {
        when.kind = Condition::Kind::Enters;
        when.at = read_point(reader, "enters");
        if (reader.has("radius") == reader.has("size"))
            reader.fail("enters", "give either radius or size", "radius = \"5 cm\"");
        if (reader.has("radius")) {
            when.radius = length("radius", kShortest);
        } else {
            const auto size = reader.quantities("size", Dimension::Length, 2);
            when.length = size[0];
            when.width = size[1];
        }
    } else if (reader.has("travels")) {
        when.kind = Condition::Kind::Travels;
        when.distance = length("travels", kShortest);
    } else if (reader.has("led")) {
        when.kind = Condition::Kind::Led;
        when.other = read_led(reader);
        when.on = reader.flag("on", true);
    } else {
        when.kind = Condition::Kind::Wheels;
        when.on = reader.choice("wheels", "", {"turn", "stop"}) == "turn";
    }
    reader.finish();
    return when;
}

Event read_event(const std::string& file, std::size_t index, const TomlValue& table) {
    const std::string fallback = fmt::format("event {}", index + 1);
    Reader reader(file, fallback, table);
    Event event;
    event.name = reader.text("label", fallback);
    event.file = file;
    event.place = fmt::format("line {}", table.line);
    const auto at = reader.optional_quantity("at", Dimension::Time);
    const TomlValue* when = reader.table("when");
    if (at.has_value() == (when != nullptr))
        reader.fail("at", at ? "both 'at' and 'when'" : "no time and no condition",
                    "either at = \"20 s\" or when = { ... }");
    const bool repeats = reader.has("every");
    if (at) {
        event.at = read_time(reader, "at", *at);
        if (repeats) {
            event.every = read_time(reader, "every", reader.quantity("every", Dimension::Time));
            if (event.every < cosim::kMillisecond)
                reader.fail("every", "every is out of range", "1 ms or more");
            event.count = 0;
        }
        if (reader.has("delay")) reader.fail("delay", "a delay without a condition", "a later 'at'");
    } else {
        event.when = read_condition(file, fallback, *when);
        event.delay = read_time(reader, "delay", reader.quantity("delay", Dimension::Time, 0.0));
        if (repeats)
            reader.fail("every", "every has no use with a condition", "count = how often it may come true");
    }
    if (reader.has("count")) {
        if (at && !repeats) reader.fail("count", "a count without repetition", "every = \"5 s\" with it");
        event.count = static_cast<std::uint64_t>(reader.integer("count", 1, 1, kMostTimes));
    }
    event.action = read_action(reader, table, table.line);
    reader.finish();
    return event;
}

}  // namespace

std::vector<Event> read_events(Reader& top) {
    std::vector<Event> events;
    for (const TomlValue* table : top.tables("event")) {
        Event event = read_event(top.file(), events.size(), *table);
        for (const Event& other : events)
            if (other.name == event.name)
                throw InputError(top.file(), event.place,
                                 fmt::format("two events are called '{}'", event.name), "different labels");
        events.push_back(std::move(event));
    }
    return events;
}

std::vector<Event> read_event_file(const std::filesystem::path& file) {
    const TomlValue root = read_toml(file);
    Reader top(file.string(), "", root);
    std::vector<Event> events = read_events(top);
    top.tables("fault");  // there may be some
    top.finish();
    return events;
}

Action parse_command(std::string_view text) {
    const TomlValue table = parse_command_text(text);
    constexpr std::string_view kCommand = "command: ";
    try {
        Reader reader("", "", table);
        Action action = read_action(reader, table, 0);
        reader.finish();
        if (const std::string problem = physics::problem_of(action); !problem.empty())
            throw InputError("", "command", problem);
        return action;
    } catch (const InputError& error) {
        const std::string what = error.what();
        throw InputError("", what.starts_with(kCommand) ? "" : "command", what);
    }
}

}  // namespace puckloop::scenarios
