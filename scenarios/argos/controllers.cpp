#include "scenarios/argos/controllers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace puckloop::argos {

namespace {

enum class Needs { MainBoard, Ground, Rab, Turret, Ircom, Omni, Front };

struct Device {
    std::string_view name;
    Needs needs;
};

// Names of the e-puck's devices: of its package, and the generic ones that its first package used.
constexpr auto kSensors = std::to_array<Device>({
    {"epuck_proximity", Needs::MainBoard},
    {"proximity", Needs::MainBoard},
    {"epuck_light", Needs::MainBoard},
    {"light", Needs::MainBoard},
    {"epuck_accelerometer", Needs::MainBoard},
    {"epuck_micro", Needs::MainBoard},
    {"epuck_battery", Needs::MainBoard},
    {"battery", Needs::MainBoard},
    {"epuck_encoder", Needs::MainBoard},
    {"differential_steering", Needs::MainBoard},
    {"epuck_ground", Needs::Ground},
    {"ground", Needs::Ground},
    {"epuck_range_and_bearing", Needs::Rab},
    {"range_and_bearing", Needs::Rab},
    {"epuck_ircom", Needs::Ircom},
    {"epuck_omnidirectional_camera", Needs::Omni},
    {"colored_blob_omnidirectional_camera", Needs::Omni},
    {"epuck_camera", Needs::Front},
    {"epuck_front_camera", Needs::Front},
});
constexpr auto kActuators = std::to_array<Device>({
    {"epuck_wheels", Needs::MainBoard},
    {"differential_steering", Needs::MainBoard},
    {"epuck_base_leds", Needs::MainBoard},
    {"leds", Needs::MainBoard},
    {"epuck_rgb_leds", Needs::Turret},
    {"epuck_range_and_bearing", Needs::Rab},
    {"range_and_bearing", Needs::Rab},
    {"epuck_ircom", Needs::Ircom},
});
/// Attributes by which the simulator makes a device worse; the emulated hardware is as bad as it is by
/// itself.
constexpr auto kNoise = std::to_array<std::string_view>(
    {"noise_level", "noise_std_dev", "noise_std_deviation", "nois_std_deviation", "noise", "loss_probability",
     "bias_min", "bias_max", "vel_noise_range", "dist_noise_range", "packet_drop_prob", "noise_std_dev_left",
     "noise_std_dev_right"});

void take(Controller& controller, Needs needs) {
    const auto camera = [&](const char* kind) {
        if (std::find(controller.cameras.begin(), controller.cameras.end(), kind) == controller.cameras.end())
            controller.cameras.emplace_back(kind);
    };
    switch (needs) {
    case Needs::MainBoard:
        break;
    case Needs::Ground:
        controller.ground = true;
        break;
    case Needs::Rab:
        controller.rab = true;
        break;
    case Needs::Turret:
        controller.turret = true;
        break;
    case Needs::Ircom:
        controller.ircom = true;
        break;
    case Needs::Omni:
        camera("omni");
        break;
    case Needs::Front:
        camera("front");
        break;
    }
}

template <typename Devices>
void take_devices(XmlFile& file, Controller& controller, const char* section, const Devices& devices) {
    for (pugi::xml_node node : controller.node.child(section).children()) {
        if (node.type() != pugi::node_element) continue;
        const auto found = std::find_if(devices.begin(), devices.end(),
                                        [&](const Device& device) { return device.name == node.name(); });
        if (found == devices.end()) {
            std::string known;
            for (const Device& device : devices)
                if (device.name.starts_with("epuck_"))
                    known += fmt::format("{}{}", known.empty() ? "" : ", ", device.name);
            file.fail(node,
                      fmt::format("controller '{}' asks for {} '{}', which the e-puck does not have",
                                  controller.id,
                                  std::string_view(section).substr(0, std::string_view(section).size() - 1),
                                  node.name()),
                      "one of " + known);
        }
        take(controller, found->needs);
        std::string noise;
        for (const pugi::xml_attribute attribute : node.attributes())
            if (std::find(kNoise.begin(), kNoise.end(), attribute.name()) != kNoise.end())
                noise += fmt::format("{}{}", noise.empty() ? "" : ", ", attribute.name());
        if (!noise.empty())
            file.note(
                node,
                fmt::format("{} of {} is not taken over: the emulated hardware has its own noise and losses",
                            noise, node.name()));
    }
}

}  // namespace

Controllers::Controllers(XmlFile& file) : file_(file) {
    for (pugi::xml_node section : file.root().children("controllers"))
        for (pugi::xml_node node : section.children()) {
            if (node.type() != pugi::node_element) continue;
            Controller controller;
            controller.id = file.text(node, "id");
            controller.node = node;
            for (const Controller& other : list_)
                if (other.id == controller.id)
                    file.fail(node,
                              fmt::format("there is another controller '{}' in line {}", other.id,
                                          file.line_of(other.node)),
                              "different ids");
            list_.push_back(controller);
        }
}

const Controller& Controllers::checked(Controller& controller) {
    bool& done = checked_[controller.id];
    if (!done) {
        take_devices(file_, controller, "sensors", kSensors);
        take_devices(file_, controller, "actuators", kActuators);
        done = true;
    }
    return controller;
}

const Controller& Controllers::of_robot(pugi::xml_node robot) {
    const pugi::xml_node node = robot.child("controller");
    if (!node)
        file_.fail(robot, fmt::format("{} has no <controller>", described(robot)),
                   "<controller config=\"...\"/>");
    const std::string id = file_.text(node, "config");
    std::string known;
    for (Controller& controller : list_) {
        if (controller.id == id) return checked(controller);
        known += (known.empty() ? "" : ", ") + controller.id;
    }
    file_.fail(node, fmt::format("there is no controller '{}'", id),
               known.empty() ? "a <controllers> section with it" : "one of " + known);
}

const Controller& Controllers::only(pugi::xml_node node) {
    if (list_.empty()) file_.fail(node, "robots without a controller", "a <controllers> section with one");
    for (Controller& controller : list_)
        if (controller.id == "automode") return checked(controller);  // the one that published ones take
    if (list_.size() > 1)
        file_.note(
            node,
            fmt::format("which of the {} controllers these robots have is the loop functions' secret: '{}', "
                        "the first, is taken",
                        list_.size(), list_.front().id));
    return checked(list_.front());
}

}  // namespace puckloop::argos
