#pragma once
// <controllers>: which boards of the robot each one's sensors and actuators need.

#include "scenarios/argos/xml_file.h"

#include <map>
#include <string>
#include <vector>

namespace puckloop::argos {

/// What a robot with a controller must carry besides main board and Linux board.
struct Controller {
    std::string id;
    pugi::xml_node node;
    bool ground = false, rab = false, turret = false, ircom = false;
    std::vector<std::string> cameras;  ///< "omni", "front"
};

class Controllers {
  public:
    /// Throws InputError for two with the same id. Noise and losses of sensors and actuators are noted.
    explicit Controllers(XmlFile& file);

    /// The one that `node` asks for by its `config`. Throws InputError where there is none, or where it needs
    /// a device that the e-puck does not have.
    const Controller& of_robot(pugi::xml_node robot);
    /// Of robots that loop functions make: "automode", as in published ones, the only one, or the first, with
    /// a note at `node`; throws InputError where there is none.
    const Controller& only(pugi::xml_node node);

  private:
    const Controller& checked(Controller& controller);

    XmlFile& file_;
    std::vector<Controller> list_;
    std::map<std::string, bool> checked_;
};

}  // namespace puckloop::argos
