#include "scenarios/reader/events/action_forms.h"

#include <algorithm>

namespace puckloop::scenarios {

namespace {

using enum ValueForm;

// clang-format off
constexpr ActionKey kMove[]{{"to", List}, {"by", List}, {"heading"}, {"over"}};
constexpr ActionKey kPut[]{{"to", List}, {"heading"}};
constexpr ActionKey kSet[]{{"grey"}, {"ambient"}, {"intensity"}, {"level"}, {"reflectivity"}, {"charge"}, {"ground"}};
constexpr ActionKey kSelect[]{{"position", Integer}};
constexpr ActionKey kTune[]{{"parameter"}, {"value"}};
constexpr ActionKey kSend[]{{"text"}, {"port", Integer}};
constexpr ActionKey kRemote[]{{"key", Integer}, {"address", Integer}, {"hold"}};

constexpr ActionForm kForms[]{
    {"move", "move OBJECT [to X, Y | by X, Y] [heading ANGLE] [over TIME]",
     "moves a thing; a robot is carried there", kMove},
    {"add", "add KIND name NAME KEY VALUE...",
     "adds a thing; keys as in its table of a scenario. KIND is wall, box, cylinder, lamp, speaker, floor_patch,\n"
     "or, for what only robots sense, virtual_wall, virtual_box, virtual_cylinder or virtual_lamp", {}},
    {"remove", "remove OBJECT", "takes a thing away", {}},
    {"lift", "lift ROBOT", "holds a robot in the air: wheels turn freely, nothing is under it", {}},
    {"put", "put ROBOT [to X, Y] [heading ANGLE]", "puts a lifted robot down", kPut},
    {"set", "set OBJECT|floor|light grey|ambient|intensity|level|reflectivity|charge|ground VALUE",
     "changes a lamp, a speaker, a patch, a body, a battery, the floor or the room's light; a robot's ground: what\n"
     "its ground sensors see in place of the floor", kSet},
    {"switch_off", "switch_off OBJECT", "a lamp or a speaker", {}},
    {"switch_on", "switch_on OBJECT", "as bright or loud as it was", {}},
    {"select", "select ROBOT position 0..15", "turns a robot's selector", kSelect},
    {"reset", "reset ROBOT", "presses a robot's reset button", {}},
    {"remote", "remote ROBOT|all key 0..63 [address 0..31] [hold TIME]",
     "presses a key of an RC5 remote control", kRemote},
    {"unset", "unset ROBOT", "its ground sensors see the floor again", {}},
    {"tune", "tune ROBOT parameter NAME value VALUE",
     "changes a physical parameter of a robot: proximity.gain3, ground.noise, robot.drift_x, ...", kTune},
    {"send", "send COMPUTER text \"TEXT\" [port N]",
     "a UDP datagram for a program of a computer on the network: port 7701 is that of puckloop-netmanager", kSend},
};

constexpr ActionKey kWall[]{{"name"}, {"from", List}, {"to", List}, {"thickness"}, {"height"}, {"reflectivity"}};
constexpr ActionKey kBox[]{{"name"}, {"centre", List}, {"size", List}, {"heading"}, {"mass"}, {"reflectivity"}};
constexpr ActionKey kCylinder[]{{"name"}, {"centre", List}, {"radius"}, {"height"}, {"mass"}, {"reflectivity"}};
constexpr ActionKey kLamp[]{{"name"}, {"centre", List}, {"height"}, {"intensity"}};
constexpr ActionKey kSpeaker[]{{"name"}, {"position", List}, {"level"}, {"height"}, {"on"}, {"off"}, {"duration"}, {"every"},
                               {"times", Integer}, {"wave"}, {"tone"}, {"sweep_to"}};
constexpr ActionKey kPatch[]{{"name"}, {"centre", List}, {"grey"}, {"shape"}, {"size", List}, {"heading"}, {"radius"}};
// Which robots sense it comes after the keys of the thing itself.
constexpr ActionKey kVirtualWall[]{{"name"}, {"from", List}, {"to", List}, {"thickness"}, {"height"}, {"reflectivity"},
                                   {"robots", List}};
constexpr ActionKey kVirtualBox[]{{"name"}, {"centre", List}, {"size", List}, {"heading"}, {"reflectivity"},
                                  {"robots", List}};
constexpr ActionKey kVirtualCylinder[]{{"name"}, {"centre", List}, {"radius"}, {"height"}, {"reflectivity"},
                                       {"robots", List}};
constexpr ActionKey kVirtualLamp[]{{"name"}, {"centre", List}, {"height"}, {"intensity"}, {"robots", List}};

constexpr ThingForm kThings[]{{"wall", kWall}, {"box", kBox}, {"cylinder", kCylinder},
                              {"lamp", kLamp}, {"speaker", kSpeaker}, {"floor_patch", kPatch},
                              {"virtual_wall", kVirtualWall}, {"virtual_box", kVirtualBox},
                              {"virtual_cylinder", kVirtualCylinder}, {"virtual_lamp", kVirtualLamp}};
// clang-format on

}  // namespace

std::span<const ActionForm> action_forms() {
    return kForms;
}

const ActionForm* action_form(std::string_view verb) {
    const auto* found = std::find_if(std::begin(kForms), std::end(kForms),
                                     [&](const ActionForm& form) { return form.verb == verb; });
    return found == std::end(kForms) ? nullptr : found;
}

std::span<const ThingForm> thing_forms() {
    return kThings;
}

const ThingForm* thing_form(std::string_view kind) {
    const auto* found = std::find_if(std::begin(kThings), std::end(kThings),
                                     [&](const ThingForm& form) { return form.kind == kind; });
    return found == std::end(kThings) ? nullptr : found;
}

std::span<const ActionKey> keys_of(std::string_view verb, std::string_view object) {
    if (verb == "add") {
        const ThingForm* thing = thing_form(object);
        return thing == nullptr ? std::span<const ActionKey>() : thing->keys;
    }
    const ActionForm* form = action_form(verb);
    return form == nullptr ? std::span<const ActionKey>() : form->keys;
}

}  // namespace puckloop::scenarios
