#include "run/factory/node_factory.h"

#include "base/error.h"
#include "cosim/can/can_bus.h"
#include "emu/avr/devices/device.h"
#include "emu/bluetooth/air_node.h"
#include "emu/i2c_devices/bus_node.h"
#include "emu/image/avr_image.h"
#include "emu/image/device.h"
#include "emu/image/image.h"
#include "emu/network/network_node.h"
#include "emu/pic/pic_node.h"
#include "emu/rab_board/rab_node.h"
#include "emu/radio/ether_node.h"
#include "emu/tam_avr/tam_node.h"
#include "emu/wifi/wifi_node.h"
#include "emu/xbee/module_node.h"
#include "linuxboard/shim/node/linux_node.h"
#include "physics/ir/ir_node.h"
#include "physics/ircom/ircom_node.h"
#include "physics/node/world_node.h"
#include "run/chips/profiled_node.h"
#include "run/chips/watched_node.h"
#include "run/control/control_socket.h"
#include "run/factory/camera_scenery.h"
#include "run/factory/outside_node.h"
#include "run/mission/mission_program.h"
#include "run/states/make_resumed.h"

#include <fmt/format.h>

namespace puckloop::tools {

namespace {

/// The board's image, and over it what its non-volatile memory kept, if the board has a file for it.
image::Image board_image(const std::string& firmware, const std::string& memory, std::string_view chip,
                         std::shared_ptr<board::NvmFile>& nvm) {
    image::Image image = image::load_image(firmware);
    if (memory.empty()) return image;
    image::check_fits(image, image::find_device(chip));
    nvm = std::make_shared<board::NvmFile>(memory, chip, image);
    return nvm->over(std::move(image));
}

std::vector<cosim::Time> times_of(const std::vector<double>& seconds) {
    std::vector<cosim::Time> times;
    for (const double time : seconds)
        times.push_back(cosim::from_seconds(time));
    return times;
}

using Faults = std::vector<cosim::CarriedFault>;

std::unique_ptr<cosim::StatefulNode> make(const MainBoard& main, Faults faults) {
    const pic::PicSpec& spec = main.board;
    pic::PicNodeOptions options;
    options.board.name = spec.name;
    options.board.seed = spec.seed;
    options.board.crystal_ppm = spec.crystal_ppm;
    options.board.adc_noise_counts = spec.adc_noise;
    options.board.phototransistor_noise_counts = spec.phototransistor_noise;
    options.board.selector = spec.selector;
    options.board.revision = *pic::revision_of(spec.revision);
    options.board.errata = dspic::errata_named(spec.errata);
    options.board.can = spec.can;
    options.ircom = spec.ircom;
    options.uart1_breaks = spec.bluetooth;
    options.log = spec.log;
    options.i2c_slave = spec.i2c_slave;
    options.fastest_i2c_hertz = main.i2c_hertz.value_or(options.fastest_i2c_hertz);
    options.resets = times_of(spec.resets);
    options.faults = std::move(faults);
    if (main.camera) {
        options.camera = camera::Fitting{*camera::model_of(main.camera->model), main.camera->turned};
        options.camera_log = main.camera_log;
        options.scenery = make_board_scenery(*main.camera);
    }
    const image::Image image = board_image(spec.firmware, spec.nvm, dspic::dspic30f6014a().name, options.nvm);
    return std::make_unique<pic::PicNode>(image, options);
}

std::unique_ptr<cosim::StatefulNode> make(const rab::RabSpec& spec, Faults faults) {
    rab::RabNodeOptions options;
    options.board.name = spec.name;
    options.board.seed = spec.seed;
    options.board.crystal_ppm = spec.crystal_ppm;
    options.board.adc_noise_counts = spec.adc_noise;
    options.board.can = spec.can;
    options.fastest_i2c_hertz = spec.i2c_hertz;
    options.log = spec.log;
    options.faults = std::move(faults);
    const image::Image image =
        board_image(spec.firmware, spec.nvm, dspic::dspic33fj256gp710().name, options.nvm);
    return std::make_unique<rab::RabNode>(image, options);
}

/// The firmware, and below it what a boot loader brings: its HEX file has two stray bytes at address 0.
image::AvrImage tam_image(const tam::TamSpec& spec) {
    const image::AvrPart part = avr::atmega1284p().image_part();
    image::AvrImage image = image::load_avr_image(spec.firmware, part);
    if (!spec.boot_loader.empty()) {
        image::AvrImage boot = image::load_avr_image(spec.boot_loader, part);
        image.flash.insert(image.flash.begin(), boot.flash.begin(), boot.flash.end());
        if (image.fuses.empty()) image.fuses = boot.fuses;
        if (!image.lock_bits) image.lock_bits = boot.lock_bits;
    }
    return image;
}

std::unique_ptr<cosim::StatefulNode> make(const tam::TamSpec& spec, Faults faults) {
    tam::TamNodeOptions options;
    options.board.name = spec.name;
    options.board.seed = spec.seed;
    options.board.resonator_ppm = spec.resonator_ppm;
    options.board.adc_noise_counts = spec.adc_noise;
    options.network = spec.network;
    options.battery = spec.battery;
    options.start = cosim::from_seconds(spec.start);
    options.log = spec.log;
    options.pins_linked = spec.pins_linked;
    options.ir_linked = spec.ir_linked;
    options.resets = times_of(spec.resets);
    options.faults = std::move(faults);
    return std::make_unique<tam::TamNode>(tam_image(spec), options);
}

std::unique_ptr<cosim::Node> make(const LinuxProgram& described, Faults faults) {
    linuxboard::LinuxSpec spec = described.program;
    linuxboard::check(spec);
    spec.faults = std::move(faults);
    return std::make_unique<linuxboard::LinuxNode>(
        std::move(spec), described.scenery ? make_scenery(*described.scenery) : nullptr);
}

std::unique_ptr<cosim::Node> make(const OutsideSpec& spec, Faults /*none*/) {
    return std::make_unique<OutsideNode>(spec);
}

std::unique_ptr<cosim::Node> make(const WorldSpec& spec, Faults /*none*/) {
    std::optional<physics::TrackerPlan> tracker;
    if (spec.tracker) tracker = {*spec.tracker, spec.mission ? make_mission_program(*spec.mission) : nullptr};
    return std::make_unique<physics::WorldNode>(
        spec.world, spec.events, spec.control.empty() ? nullptr : make_control_socket(spec.control),
        physics::PosePorts{spec.bluetooth, spec.wifi}, std::move(tracker));
}

std::unique_ptr<cosim::Node> make(const physics::IrSpec& spec, Faults faults) {
    physics::IrNodeOptions options = spec.options;
    options.faults = std::move(faults);
    return std::make_unique<physics::IrNode>(spec.world, options);
}

std::unique_ptr<cosim::Node> make(const physics::IrcomSpec& spec, Faults faults) {
    physics::IrcomNodeOptions options = spec.options;
    options.faults = std::move(faults);
    return std::make_unique<physics::IrcomNode>(spec.world, options);
}

std::unique_ptr<cosim::Node> make(i2c_devices::BusSpec spec, Faults faults) {
    spec.faults = std::move(faults);
    return i2c_devices::make_bus_node(spec);
}

std::unique_ptr<cosim::Node> make(cosim::CanBusOptions spec, Faults faults) {
    spec.faults = std::move(faults);
    return std::make_unique<cosim::CanBusNode>(std::move(spec));
}

std::unique_ptr<cosim::Node> make(const xbee::ModuleSpec& spec, Faults /*none*/) {
    return std::make_unique<xbee::ModuleNode>(spec.module, spec.pins);
}

std::unique_ptr<cosim::Node> make(const bluetooth::AirSpec& spec, Faults /*none*/) {
    return std::make_unique<bluetooth::AirNode>(spec);
}

std::unique_ptr<cosim::Node> make(radio::EtherSpec spec, Faults faults) {
    spec.faults = std::move(faults);
    return std::make_unique<radio::EtherNode>(spec);
}

std::unique_ptr<cosim::Node> make(network::NetworkSpec spec, Faults faults) {
    spec.faults = std::move(faults);
    return std::make_unique<network::NetworkNode>(spec);
}

std::unique_ptr<cosim::Node> make(wifi::WifiSpec spec, Faults faults) {
    spec.faults = std::move(faults);
    return std::make_unique<wifi::WifiNode>(spec);
}

}  // namespace

std::unique_ptr<cosim::StatefulNode> make_board(const NodeDescription& node) {
    return std::visit(
        [&]<class Kind>(const Kind& kind) -> std::unique_ptr<cosim::StatefulNode> {
            if constexpr (is_board<Kind>) {
                std::unique_ptr<cosim::StatefulNode> board = make(kind, cosim::carried(node.faults));
                NodeDescription copy = node;
                const std::string& firmware = board_fields(copy).firmware;
                if (!node.care.watches.empty())
                    board = make_watched(std::move(board), firmware, node.care.watches);
                if (node.care.stats) board = make_profiled(std::move(board), firmware);
                return board;
            } else {
                throw std::logic_error("no board");
            }
        },
        node.kind);
}

std::unique_ptr<cosim::Node> make_node(const NodeDescription& node) {
    if (has_board(node)) return with_state(node, [node] { return make_board(node); });
    return std::visit(
        [&](const auto& kind) -> std::unique_ptr<cosim::Node> {
            return make(kind, cosim::carried(node.faults));
        },
        node.kind);
}

std::unique_ptr<cosim::Node> make_described(const std::string& text) {
    return make_node(decode(text));
}

}  // namespace puckloop::tools
