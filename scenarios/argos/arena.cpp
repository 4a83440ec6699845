#include "scenarios/argos/arena.h"

#include "base/error.h"
#include "scenarios/argos/controllers.h"
#include "scenarios/argos/distribute.h"
#include "scenarios/argos/loop_places.h"

#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <map>

namespace puckloop::argos {

namespace {

bool is_png(const std::filesystem::path& file) {
    char head[8]{};
    std::ifstream stream(file, std::ios::binary);
    stream.read(head, sizeof head);
    return stream.gcount() == sizeof head && std::memcmp(head, "\x89PNG\r\n\x1A\n", sizeof head) == 0;
}

/// Width and height from the first chunk of a PNG file; zeros where there is none.
std::pair<double, double> png_size(const std::filesystem::path& file) {
    unsigned char head[24]{};
    std::ifstream stream(file, std::ios::binary);
    stream.read(reinterpret_cast<char*>(head), sizeof head);
    if (stream.gcount() != sizeof head) return {0.0, 0.0};
    const auto word = [&](std::size_t at) {
        return static_cast<double>(
            (head[at] << 24U | head[at + 1] << 16U | head[at + 2] << 8U | head[at + 3]) & 0x7FFFFFFF);
    };
    return {word(16), word(20)};
}

class Arena {
  public:
    Arena(XmlFile& file, const Options& options, Tree& root)
        : file_(file), options_(options), root_(root), controllers_(file) {
        node_ = file.root().child("arena");
        if (!node_) file.fail(file.root(), "there is no <arena>", "an experiment with an arena");
        const auto size = file.numbers(node_, "size", 3);
        const auto centre = file.numbers(node_, "center", 3, std::vector<double>{0.0, 0.0, 0.0});
        if (!(size[0] > 0.0 && size[1] > 0.0)) file.fail(node_, "<arena>: size is not above 0", "\"4,4,1\"");
        width_ = size[0];
        depth_ = size[1];
        x_ = centre[0];
        y_ = centre[1];
    }

    void add() {
        Tree arena(file_.line_of(node_));
        if (x_ == 0.0 && y_ == 0.0) {
            arena.lengths("size", {width_, depth_});
        } else {
            const auto corner = [&](double right, double up) {
                const int line = file_.line_of(node_);
                return list_of({text_value(quantity_text(x_ + right * width_ / 2, "m"), line),
                                text_value(quantity_text(y_ + up * depth_ / 2, "m"), line)},
                               line);
            };
            arena.set("corners", list_of({corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)},
                                         file_.line_of(node_)));
        }
        arena.flag("walls", false);  // ARGoS' arena is where things may be: nothing stands around it
        root_.table("arena", arena);
        mission_ = read_loop_places(file_, root_);
        for (const pugi::xml_node thing : node_.children())
            if (thing.type() == pugi::node_element) add_thing(thing);
        if (!floor_done_ && !options_.floor.empty()) add_floor_file(node_, options_.floor, true);
        add_missions_robots();
        refuse_no_robots();
        if (ircom_) root_.table("ircom", Tree(file_.line_of(node_)));
    }

  private:
    bool mission_places() const { return mission_.radius > 0.0; }

    void add_thing(pugi::xml_node node) {
        const std::string_view kind = node.name();
        if (kind == "box")
            add_body("box", node, [&](Tree& tree) { box_keys(file_, node, tree); });
        else if (kind == "cylinder")
            add_body("cylinder", node, [&](Tree& tree) { cylinder_keys(file_, node, tree); });
        else if (kind == "light")
            add_light(node);
        else if (kind == "floor")
            add_floor(node);
        else if (kind == "e-puck")
            add_robot(node);
        else if (kind == "tams")
            add_tams(node);
        else if (kind == "tam")
            add_tam(node);
        else if (kind == "distribute")
            add_distributed(node);
        else
            file_.fail(node, fmt::format("<{}> is no thing that can be here", kind),
                       "e-puck, tams, box, cylinder, light, floor or distribute");
    }

    struct Pose {
        double x = 0.0, y = 0.0, heading = 0.0;  // m, m, deg
    };
    Pose pose_of(pugi::xml_node node) {
        const pugi::xml_node body = node.child("body");
        if (!body)
            file_.fail(node, fmt::format("{} has no <body>", described(node)),
                       "<body position=\"0,0,0\" orientation=\"0,0,0\"/>");
        const auto position = file_.numbers(body, "position", 3);
        const auto turn = file_.numbers(body, "orientation", 3, std::vector<double>{0.0, 0.0, 0.0});
        if (position[2] != 0.0)
            file_.note(body, fmt::format("{} is {:.4g} m above the floor: here it stands on it",
                                         described(node), position[2]));
        if (turn[1] != 0.0 || turn[2] != 0.0)
            file_.note(body, fmt::format("{}: its turns about y and x are not taken over: it stands upright",
                                         described(node)));
        return {position[0], position[1], turn[0]};
    }

    template <typename Keys>
    void add_body(const char* kind, pugi::xml_node node, Keys keys) {
        Tree tree(file_.line_of(node));
        const Pose pose = pose_of(node);
        tree.text("name", file_.text(node, "id")).lengths("centre", {pose.x, pose.y});
        if (std::string_view(kind) == "box") tree.quantity("heading", pose.heading, "deg");
        keys(tree);
        root_.add(kind, tree);
    }

    void add_light(pugi::xml_node node) {
        const auto position = file_.numbers(node, "position", 3);
        Tree tree(file_.line_of(node));
        tree.text("name", file_.text(node, "id")).lengths("centre", {position[0], position[1]});
        lamp_keys(file_, node, tree);
        root_.add("lamp", tree);
    }

    void add_floor(pugi::xml_node node) {
        if (floor_done_) file_.fail(node, "a second <floor>", "one floor");
        const std::string source = file_.text(node, "source");
        if (source != "image" && source != "loop_functions")
            file_.fail(node, fmt::format("<floor>: there is no source '{}'", source),
                       "image or loop_functions");
        if (!options_.floor.empty()) {
            add_floor_file(node, options_.floor, true);
        } else if (source == "loop_functions") {
            file_.note(node,
                       "the floor is painted by the loop functions, which are not executed: it is white here "
                       "(--floor FILE.png gives it)");
        } else {
            const std::string path = file_.text(node, "path");
            std::filesystem::path found;
            std::error_code ignored;
            for (const auto& place :
                 {std::filesystem::path(file_.name()).parent_path() / path, std::filesystem::path(path)})
                if (found.empty() && std::filesystem::is_regular_file(place, ignored)) found = place;
            if (found.empty())
                file_.note(
                    node,
                    fmt::format(
                        "there is no floor image '{}': the floor is white here (--floor FILE.png gives it)",
                        path));
            else if (!is_png(found))
                file_.note(node, fmt::format("the floor image '{}' is no PNG file: the floor is white here "
                                             "(--floor FILE.png gives it)",
                                             path));
            else
                add_floor_file(node, found, false);
        }
        floor_done_ = true;
    }

    /// Over the whole arena, as ARGoS lays it, or of the size that --floor-scale gives.
    void add_floor_file(pugi::xml_node node, const std::filesystem::path& image, bool of_option) {
        std::error_code error;
        if (of_option && !std::filesystem::is_regular_file(image, error))
            throw InputError(image.string(), "", "there is no such file", "a PNG file for --floor");
        double length = width_, width = depth_;
        if (options_.pixels_per_metre > 0.0) {
            const auto [columns, rows] = png_size(image);
            if (!(columns > 0.0 && rows > 0.0))
                throw InputError(image.string(), "", "is no PNG file", "a PNG file for --floor");
            length = columns / options_.pixels_per_metre;
            width = rows / options_.pixels_per_metre;
        }
        Tree patch(file_.line_of(node));
        patch.text("name", "floor").text("image", std::filesystem::absolute(image).string());
        patch.lengths("centre", {x_, y_}).lengths("size", {length, width});
        root_.add("floor_patch", patch);
        floor_done_ = true;
    }

    RobotTemplate robot_template() {
        return [this](int line, const Controller& controller, const std::string&) {
            return robot_tree(line, controller);
        };
    }

    Tree robot_tree(int line, const Controller& controller) {
        Tree robot(line);
        robot.flag("ground_sensor", controller.ground).flag("rgb_turret", controller.turret);
        robot.table("pic", Tree(line).text("firmware", controller.ircom ? "ircom" : "own"));
        if (controller.rab) robot.table("rab", Tree(line).text("firmware", "own"));
        Tree program(line);
        program.texts("arguments",
                      {"-c", std::filesystem::absolute(file_.name()).string(), "-i", controller.id});
        if (!controller.cameras.empty()) program.texts("cameras", controller.cameras);
        robot.table("linux", program);
        ircom_ = ircom_ || controller.ircom;
        robots_ = true;
        return robot;
    }

    void add_robot(pugi::xml_node node) {
        const Controller& controller = controllers_.of_robot(node);
        const std::string name = robot_name(file_, node, file_.text(node, "id"));
        const Pose pose = pose_of(node);
        if (mission_places()) return take_for_mission(controller, name, file_.line_of(node));
        Tree robot = robot_tree(file_.line_of(node), controller);
        robot.text("name", name)
            .lengths("position", {pose.x, pose.y})
            .quantity("heading", pose.heading, "deg");
        root_.add("robot", robot);
    }

    /// The loop functions of a mission move robots from wherever they were put.
    void take_for_mission(const Controller& controller, const std::string& name, int line) {
        placed_.try_emplace(controller.id, Placed{controller, line, {}}).first->second.names.push_back(name);
    }

    void add_distributed(pugi::xml_node node) {
        const pugi::xml_node entity = node.child("entity"), robot = entity.child("e-puck");
        if (!robot || !mission_places())
            return add_distribution(file_, node, controllers_, robot_template(), root_);
        const Distributed wanted = distributed(file_, entity);
        const Controller& controller = controllers_.of_robot(robot);
        const std::string name = robot_name(file_, robot, file_.text(robot, "id"));
        for (long long i = 0; i < wanted.count; ++i)
            take_for_mission(controller, fmt::format("{}{}", name, wanted.first + i), file_.line_of(robot));
    }

    /// Programs of the simulator place robots in many experiments, each in its own way.
    void refuse_no_robots() {
        const pugi::xml_node loop = file_.root().child("loop_functions");
        if (robots_ || !loop) return;
        file_.fail(loop, "there are no robots: the loop functions place them, which are not executed",
                   "<e-puck> or <distribute> in <arena>, or <params number_robots=\"20\" "
                   "dist_radius=\"1\"/>");
    }

    void add_missions_robots() {
        if (!mission_places()) return;
        if (placed_.empty() && mission_.robots > 0) {
            const Controller& controller = controllers_.only(mission_.params);
            for (long long i = 1; i <= mission_.robots; ++i)
                take_for_mission(controller, fmt::format("epuck{}", i), file_.line_of(mission_.params));
        }
        if (placed_.empty()) return;
        file_.note(
            mission_.params,
            fmt::format(
                "the loop functions place the robots: here they are drawn in a disc of {:.4g} m, and nothing "
                "else of the loop functions is executed",
                mission_.radius));
        for (const auto& [id, placed] : placed_) {
            Tree group = robot_tree(placed.line, placed.controller);
            group.texts("names", placed.names);
            group.table("place",
                        Tree(placed.line).text("kind", "disc").quantity("radius", mission_.radius, "m"));
            root_.add("group", group);
        }
    }

    void add_tams(pugi::xml_node node) {
        for (const char* attribute : {"java_class_path", "experiment_class"})
            if (node.attribute(attribute))
                file_.note(node,
                           "the coordinator of the TAMs is not taken over (a table [coordinator] has one)");
        for (const pugi::xml_node tam : node.children())
            if (tam.type() == pugi::node_element) {
                if (std::string_view(tam.name()) != "tam")
                    file_.fail(tam, fmt::format("<{}> among TAMs", tam.name()), "<tam>");
                add_tam(tam, node);
            }
    }

    void add_tam(pugi::xml_node node, pugi::xml_node around = {}) {
        const Pose pose = pose_of(node);
        Tree tam(file_.line_of(node));
        tam.text("name", robot_name(file_, node, file_.text(node, "id")))
            .lengths("position", {pose.x, pose.y});
        tam.quantity("heading", pose.heading, "deg");
        const pugi::xml_node with = node.attribute("network") ? node : around;
        if (with.attribute("network")) tam.integer("network", file_.integer(with, "network", 0, 3));
        if (file_.flag(node, "movable", false))
            file_.note(node, fmt::format("{} does not move here", described(node)));
        robots_ = true;
        root_.add("tam", tam);
    }

    XmlFile& file_;
    const Options& options_;
    Tree& root_;
    Controllers controllers_;
    pugi::xml_node node_;
    double width_ = 0.0, depth_ = 0.0, x_ = 0.0, y_ = 0.0;
    LoopPlaces mission_;
    /// Robots of one controller that the mission places.
    struct Placed {
        Controller controller;
        int line = 0;  // of the first
        std::vector<std::string> names;
    };
    std::map<std::string, Placed> placed_;  // by the controller's id
    bool floor_done_ = false, ircom_ = false;
    bool robots_ = false;  // or TAMs, are there
};

}  // namespace

void box_keys(XmlFile& file, pugi::xml_node node, Tree& tree) {
    const auto size = file.numbers(node, "size", 3);
    tree.lengths("size", size);
    if (file.flag(node, "movable", false)) tree.quantity("mass", file.number(node, "mass", 1.0), "kg");
}

void cylinder_keys(XmlFile& file, pugi::xml_node node, Tree& tree) {
    tree.quantity("radius", file.number(node, "radius"), "m")
        .quantity("height", file.number(node, "height"), "m");
    if (file.flag(node, "movable", false)) tree.quantity("mass", file.number(node, "mass", 1.0), "kg");
}

void lamp_keys(XmlFile& file, pugi::xml_node node, Tree& tree) {
    tree.quantity("height", file.numbers(node, "position", 3, std::vector<double>{0.0, 0.0, 0.05})[2], "m");
    tree.number("intensity", file.number(node, "intensity"));
}

void add_arena(XmlFile& file, const Options& options, Tree& root) {
    Arena(file, options, root).add();
}

}  // namespace puckloop::argos
