#pragma once
// What the loop functions of published missions state of the room: where robots begin, and walls that they
// build. The programs themselves are not executed.
//
// Source: parameters as AutoMoDe's loop functions read them (demiurge project), and the arena entity that
// they build walls with.

#include "scenarios/argos/toml_tree.h"
#include "scenarios/argos/xml_file.h"

namespace puckloop::argos {

struct LoopPlaces {
    pugi::xml_node params;
    double radius = 0.0;   ///< m, of the disc about the origin that all robots are put into; 0: there is none
    long long robots = 0;  ///< that are made where the arena has none
};

/// Adds the walls to `root`. Throws InputError for parameters out of range.
LoopPlaces read_loop_places(XmlFile& file, Tree& root);

}  // namespace puckloop::argos
