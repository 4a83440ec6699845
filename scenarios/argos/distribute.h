#pragma once
// <distribute>, and robots that loop functions place: as groups that are drawn by the run's seed.

#include "scenarios/argos/controllers.h"
#include "scenarios/argos/toml_tree.h"
#include "scenarios/argos/xml_file.h"

#include <functional>
#include <string>

namespace puckloop::argos {

/// A group of robots with this controller, without names and places.
using RobotTemplate = std::function<Tree(int line, const Controller& controller, const std::string& key)>;

/// How many things an <entity> has, and the number at the end of the first one's name.
struct Distributed {
    long long count = 0, first = 0;
};
Distributed distributed(XmlFile& file, pugi::xml_node entity);

/// One <distribute>, or nothing where its quantity is 0.
void add_distribution(XmlFile& file, pugi::xml_node node, Controllers& controllers,
                      const RobotTemplate& robot, Tree& root);

/// A name that robots may have here: other signs than letters, digits, _ and - become _, which is noted.
std::string robot_name(XmlFile& file, pugi::xml_node node, const std::string& id);

}  // namespace puckloop::argos
