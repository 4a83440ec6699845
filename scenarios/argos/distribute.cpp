#include "scenarios/argos/distribute.h"

#include "scenarios/argos/arena.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace puckloop::argos {

namespace {

void only_on_the_floor(XmlFile& file, pugi::xml_node node, double z) {
    if (z != 0.0)
        file.note(node, fmt::format("{}: the height z is not taken over: everything is on the floor",
                                    described(node)));
}

void add_place(XmlFile& file, pugi::xml_node position, pugi::xml_node entity, long long quantity,
               Tree& place) {
    const std::string method = file.text(position, "method");
    const auto random = [&] {
        place.integer("max_trials", file.integer(entity, "max_trials", 1, 1'000'000));
    };
    const auto point = [](const std::vector<double>& v) { return std::vector<double>{v[0], v[1]}; };
    if (method == "uniform") {
        const auto low = file.numbers(position, "min", 3), high = file.numbers(position, "max", 3);
        for (std::size_t i = 0; i < 3; ++i)
            if (low[i] > high[i])
                file.fail(position, fmt::format("{}: min is above max", described(position)),
                          "min of at most max");
        only_on_the_floor(file, position, low[2] == high[2] ? low[2] : 1.0);
        place.text("kind", "rectangle");
        place.lengths("centre", {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2});
        place.lengths("size", {high[0] - low[0], high[1] - low[1]});
        random();
    } else if (method == "gaussian") {
        const auto mean = file.numbers(position, "mean", 3), deviation = file.numbers(position, "std_dev", 3);
        only_on_the_floor(file, position, deviation[2] == 0.0 ? mean[2] : 1.0);
        if (deviation[0] < 0.0 || deviation[1] < 0.0)
            file.fail(position, fmt::format("{}: std_dev is below 0", described(position)), "0 or more");
        place.text("kind", "normal").lengths("centre", point(mean)).lengths("deviation", point(deviation));
        random();
    } else if (method == "constant") {
        const auto values = file.numbers(position, "values", 3);
        only_on_the_floor(file, position, values[2]);
        std::vector<TomlValue> positions;
        for (long long i = 0; i < quantity; ++i)
            positions.push_back(list_of({text_value(quantity_text(values[0], "m"), place.line()),
                                         text_value(quantity_text(values[1], "m"), place.line())},
                                        place.line()));
        place.text("kind", "list").set("positions", list_of(positions, place.line()));
    } else if (method == "grid") {
        const auto centre = file.numbers(position, "center", 3),
                   distances = file.numbers(position, "distances", 3),
                   layout = file.numbers(position, "layout", 3);
        only_on_the_floor(file, position, centre[2]);
        for (const double cells : layout)
            if (!(cells >= 1.0 && cells <= 1000.0) || cells != static_cast<double>(static_cast<int>(cells)))
                file.fail(position, fmt::format("{}: layout has '{}'", described(position), cells),
                          "three whole numbers from 1 to 1000");
        if (layout[2] != 1.0)
            file.fail(position, fmt::format("{}: a grid of {} layers", described(position), layout[2]),
                      "one layer, on the floor");
        if (static_cast<double>(quantity) > layout[0] * layout[1])
            file.fail(entity, fmt::format("{} things in a grid of {} x {}", quantity, layout[0], layout[1]),
                      "at most as many as it has places");
        place.text("kind", "grid").lengths("centre", point(centre)).lengths("distance", point(distances));
        place.integer("columns", static_cast<std::int64_t>(layout[0]));
        place.integer("rows", static_cast<std::int64_t>(layout[1]));
    } else {
        file.fail(position, fmt::format("there is no method '{}' of distribution", method),
                  "uniform, gaussian, constant or grid");
    }
}

void add_heading(XmlFile& file, pugi::xml_node orientation, Tree& place) {
    const std::string method = file.text(orientation, "method");
    const auto upright = [&](const std::vector<double>& values) {
        if (values[1] != 0.0 || values[2] != 0.0)
            file.note(orientation, "turns about y and x are not taken over: everything stands upright");
    };
    if (method == "uniform") {
        const auto low = file.numbers(orientation, "min", 3), high = file.numbers(orientation, "max", 3);
        if (low[0] > high[0])
            file.fail(orientation, fmt::format("{}: min is above max", described(orientation)),
                      "min of at most max");
        upright(low);
        upright(high);
        place.text("heading", fmt::format("uniform({} deg, {} deg)", low[0], high[0]));
    } else if (method == "gaussian") {
        const auto mean = file.numbers(orientation, "mean", 3),
                   deviation = file.numbers(orientation, "std_dev", 3);
        if (deviation[0] < 0.0)
            file.fail(orientation, fmt::format("{}: std_dev is below 0", described(orientation)),
                      "0 or more");
        upright(mean);
        upright(deviation);
        place.text("heading", fmt::format("normal({} deg, {} deg)", mean[0], deviation[0]));
    } else if (method == "constant") {
        const auto values = file.numbers(orientation, "values", 3);
        upright(values);
        place.quantity("heading", values[0], "deg");
    } else {
        file.fail(orientation, fmt::format("there is no method '{}' of orientation", method),
                  "uniform, gaussian or constant");
    }
}

}  // namespace

std::string robot_name(XmlFile& file, pugi::xml_node node, const std::string& id) {
    std::string name = id;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
    if (name != id) file.note(node, fmt::format("'{}' is called '{}' here", id, name));
    return name;
}

Distributed distributed(XmlFile& file, pugi::xml_node entity) {
    constexpr long long kMost = 1000;
    return {file.integer(entity, "quantity", 0, kMost), file.integer(entity, "base_num", 0, 1'000'000, 0)};
}

void add_distribution(XmlFile& file, pugi::xml_node node, Controllers& controllers,
                      const RobotTemplate& robot, Tree& root) {
    const auto child = [&](const char* name) {
        const pugi::xml_node found = node.child(name);
        if (!found) file.fail(node, fmt::format("<distribute> has no <{}>", name));
        return found;
    };
    const pugi::xml_node position = child("position"), orientation = child("orientation"),
                         entity = child("entity");
    const auto [quantity, first] = distributed(file, entity);
    if (quantity == 0) return;
    pugi::xml_node thing;
    for (const pugi::xml_node one : entity.children())
        if (one.type() == pugi::node_element && !thing) thing = one;
    if (!thing) file.fail(entity, "<entity> has nothing to distribute", "<e-puck id=\"ep\"> and the like");
    const std::string kind = thing.name(), id = file.text(thing, "id");
    const int line = file.line_of(thing);

    std::string of;
    Tree group(line);
    if (kind == "e-puck") {
        of = "robot";
        group = robot(line, controllers.of_robot(thing), "");
    } else if (kind == "box") {
        of = "box";
        box_keys(file, thing, group);
    } else if (kind == "cylinder") {
        of = "cylinder";
        cylinder_keys(file, thing, group);
    } else if (kind == "light") {
        of = "lamp";
        lamp_keys(file, thing, group);
    } else {
        file.fail(thing, fmt::format("<{}> cannot be distributed here", kind),
                  "e-puck, box, cylinder or light");
    }
    Tree place(file.line_of(position));
    add_place(file, position, entity, quantity, place);
    if (of == "robot" || of == "box") add_heading(file, orientation, place);
    group.text("of", of).text("name", (of == "robot" ? robot_name(file, thing, id) : id) + "{n}");
    group.integer("count", quantity).integer("first", first).table("place", place);
    root.add("group", group);
}

}  // namespace puckloop::argos
