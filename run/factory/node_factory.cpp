#include "run/factory/node_factory.h"

#include "base/error.h"
#include "cosim/can/can_bus.h"
#include "cosim/faults/fault_json.h"
#include "emu/avr/device.h"
#include "emu/bluetooth/air_node.h"
#include "emu/i2c_devices/bus_node.h"
#include "emu/image/avr_image.h"
#include "emu/image/device.h"
#include "emu/image/image.h"
#include "emu/pic/pic_node.h"
#include "emu/rab_board/rab_node.h"
#include "emu/radio/ether_node.h"
#include "emu/tam_avr/tam_node.h"
#include "emu/xbee/module_node.h"
#include "linuxboard/shim/node/linux_node.h"
#include "physics/ir/ir_node.h"
#include "physics/ircom/ircom_node.h"
#include "physics/node/world_node.h"
#include "run/control/control_socket.h"
#include "run/factory/outside_node.h"
#include "run/plan/camera_scenery.h"
#include "run/states/make_resumed.h"
#include "run/stats/profiled_node.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace puckloop::tools {

namespace {

using nlohmann::json;

/// The board's image, and over it what its non-volatile memory kept, if the board has a file for it.
image::Image board_image(const json& spec, std::string_view chip, std::shared_ptr<board::NvmFile>& nvm) {
    image::Image image = image::load_image(spec.at("firmware").get<std::string>());
    if (const std::string path = spec.value("nvm", ""); !path.empty()) {
        image::check_fits(image, image::find_device(chip));
        nvm = std::make_shared<board::NvmFile>(path, chip, image);
        image = nvm->over(std::move(image));
    }
    return image;
}

/// The faults that the node carries out.
std::vector<cosim::CarriedFault> faults_of(const json& spec) {
    if (!spec.contains("faults")) return {};
    return cosim::faults_from_json(spec["faults"]);
}

std::unique_ptr<cosim::StatefulNode> make_pic(const json& spec) {
    pic::PicNodeOptions options;
    options.board.name = spec.at("name");
    options.board.seed = spec.at("seed");
    options.board.crystal_ppm = spec.at("crystal_ppm");
    options.board.adc_noise_counts = spec.at("adc_noise");
    if (spec.contains("phototransistor_noise"))
        options.board.phototransistor_noise_counts = spec.at("phototransistor_noise");
    options.board.selector = spec.at("selector");
    if (spec.contains("board")) options.board.revision = *pic::revision_of(spec["board"].get<std::string>());
    options.board.errata = dspic::errata_named(spec.value("errata", std::vector<std::string>{}));
    options.ircom = spec.value("ircom", false);
    options.uart1_breaks = spec.value("bluetooth", false);
    options.board.can = spec.value("can", board::CanModules{0});
    options.log = spec.value("log", "");
    for (const double seconds : spec.at("resets").get<std::vector<double>>())
        options.resets.push_back(cosim::from_seconds(seconds));
    options.faults = faults_of(spec);
    if (spec.contains("camera")) {
        const json& camera = spec["camera"];
        options.camera = camera::Fitting{*camera::model_of(camera.at("model").get<std::string>()),
                                         camera.at("turned").get<bool>()};
        options.camera_log = spec.at("camera_log");
        options.fastest_i2c_hertz = spec.at("i2c_hertz");
        options.scenery = make_board_scenery(camera);
    }
    const image::Image image = board_image(spec, dspic::dspic30f6014a().name, options.nvm);
    return std::make_unique<pic::PicNode>(image, options);
}

std::unique_ptr<cosim::StatefulNode> make_rab(const json& spec) {
    rab::RabNodeOptions options;
    options.board.name = spec.at("name");
    options.board.seed = spec.at("seed");
    options.board.crystal_ppm = spec.at("crystal_ppm");
    options.board.adc_noise_counts = spec.at("adc_noise");
    options.fastest_i2c_hertz = spec.at("i2c_hertz");
    options.board.can = spec.value("can", board::CanModules{0});
    options.log = spec.value("log", "");
    options.faults = faults_of(spec);
    const image::Image image = board_image(spec, dspic::dspic33fj256gp710().name, options.nvm);
    return std::make_unique<rab::RabNode>(image, options);
}

/// The firmware, and below it what a boot loader brings: its HEX file has two stray bytes at address 0.
image::AvrImage tam_image(const json& spec) {
    const image::AvrPart part = avr::atmega1284p().image_part();
    image::AvrImage image = image::load_avr_image(spec.at("firmware").get<std::string>(), part);
    if (const std::string path = spec.value("boot_loader", ""); !path.empty()) {
        image::AvrImage boot = image::load_avr_image(path, part);
        image.flash.insert(image.flash.begin(), boot.flash.begin(), boot.flash.end());
        if (image.fuses.empty()) image.fuses = boot.fuses;
        if (!image.lock_bits) image.lock_bits = boot.lock_bits;
    }
    return image;
}

std::unique_ptr<cosim::StatefulNode> make_tam(const json& spec) {
    tam::TamNodeOptions options;
    options.board.name = spec.at("name");
    options.board.seed = spec.at("seed");
    options.board.resonator_ppm = spec.at("resonator_ppm");
    options.board.adc_noise_counts = spec.at("adc_noise");
    options.network = spec.at("network");
    options.battery = spec.at("battery_v");
    options.start = cosim::from_seconds(spec.at("start_s"));
    options.log = spec.value("log", "");
    options.pins_linked = spec.value("pins_linked", false);
    options.ir_linked = spec.value("ir_linked", false);
    for (const double seconds : spec.at("resets").get<std::vector<double>>())
        options.resets.push_back(cosim::from_seconds(seconds));
    options.faults = faults_of(spec);
    return std::make_unique<tam::TamNode>(tam_image(spec), options);
}

std::unique_ptr<cosim::Node> make_linux(json spec) {
    spec.erase("kind");
    std::unique_ptr<linuxboard::Scenery> scenery;
    if (spec.contains("scenery")) scenery = make_scenery(spec["scenery"]);
    spec.erase("scenery");
    return std::make_unique<linuxboard::LinuxNode>(linuxboard::parse_linux_spec(spec.dump()),
                                                   std::move(scenery));
}

std::unique_ptr<cosim::Node> make_outside(const json& spec) {
    OutsideSpec outside;
    outside.name = spec.at("name");
    outside.end = parse_outside(outside.name, spec.at("end"), spec.at("folder"));
    outside.baud = spec.at("baud");
    outside.record = spec.at("record");
    outside.quiet = spec.value("quiet_ps", cosim::Time{0});
    return std::make_unique<OutsideNode>(outside);
}

std::unique_ptr<cosim::Node> make_world(const json& spec) {
    const std::string control = spec.at("control");
    return physics::make_world_node(spec.at("world").dump(), spec.at("events").dump(),
                                    control.empty() ? nullptr : make_control_socket(control),
                                    spec.value("bluetooth", false));
}

}  // namespace

std::unique_ptr<cosim::StatefulNode> make_board(const json& spec) {
    const std::string kind = spec.at("kind");
    std::unique_ptr<cosim::StatefulNode> board = kind == "tam"   ? make_tam(spec)
                                                 : kind == "pic" ? make_pic(spec)
                                                                 : make_rab(spec);
    if (!spec.value("stats", false)) return board;
    return make_profiled(std::move(board), spec.at("firmware"));
}

std::unique_ptr<cosim::Node> make_node(const std::string& text) {
    try {
        const json spec = json::parse(text);
        const std::string kind = spec.at("kind");
        if (kind == "pic" || kind == "rab" || kind == "tam")
            return with_state(spec, [spec] { return make_board(spec); });
        if (kind == "linux") return make_linux(spec);
        if (kind == "world") return make_world(spec);
        if (kind == "ir") return physics::make_ir_node(text);
        if (kind == "ircom") return physics::make_ircom_node(text);
        if (kind == "i2c_bus") return i2c_devices::make_bus_node(text);
        if (kind == "can_bus") return cosim::make_can_bus(text);
        if (kind == "outside") return make_outside(spec);
        if (kind == "xbee") return xbee::make_module_node(text);
        if (kind == "bluetooth") return bluetooth::make_air_node(text);
        if (kind == "ether") return radio::make_ether_node(text);
        throw InputError("", "node", fmt::format("unknown kind '{}'", kind));
    } catch (const json::exception& error) {
        throw InputError("", "node description", error.what());
    }
}

}  // namespace puckloop::tools
