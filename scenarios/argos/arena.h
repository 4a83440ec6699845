#pragma once
// <arena>: the room, what is in it, the floor, the robots.

#include "scenarios/argos/import.h"
#include "scenarios/argos/toml_tree.h"
#include "scenarios/argos/xml_file.h"

namespace puckloop::argos {

void add_arena(XmlFile& file, const Options& options, Tree& root);

/// What boxes, cylinders and lamps are apart from where they are.
void box_keys(XmlFile& file, pugi::xml_node node, Tree& tree);
void cylinder_keys(XmlFile& file, pugi::xml_node node, Tree& tree);
/// Height and intensity; a light's height is the z of its position.
void lamp_keys(XmlFile& file, pugi::xml_node node, Tree& tree);

}  // namespace puckloop::argos
