#pragma once
// What a node of a run is made from: one struct per kind, each with the list of its fields.

#include "base/fields/json.h"
#include "cosim/can/can_bus.h"
#include "cosim/faults/node_fault.h"
#include "emu/bluetooth/air_node.h"
#include "emu/i2c_devices/bus_node.h"
#include "emu/network/network_node.h"
#include "emu/rab_board/rab_spec.h"
#include "emu/radio/ether_node.h"
#include "emu/tam_avr/tam_spec.h"
#include "emu/wifi/wifi_node.h"
#include "emu/xbee/module_node.h"
#include "physics/ir/ir_node.h"
#include "physics/ircom/ircom_node.h"
#include "run/description/board_care.h"
#include "run/description/linux_program.h"
#include "run/description/main_board.h"
#include "run/description/outside_spec.h"
#include "run/description/world_spec.h"

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace puckloop::tools {

using NodeKind = std::variant<MainBoard, rab::RabSpec, tam::TamSpec, LinuxProgram, WorldSpec, physics::IrSpec,
                              physics::IrcomSpec, i2c_devices::BusSpec, cosim::CanBusOptions, OutsideSpec,
                              xbee::ModuleSpec, bluetooth::AirSpec, radio::EtherSpec, network::NetworkSpec,
                              wifi::WifiSpec>;

struct NodeDescription {
    NodeKind kind;
    std::vector<cosim::NodeFault> faults{};  ///< that the node carries out
    BoardCare care{};                        ///< of a board
};

/// "pic", "rab", "tam", "linux", "world", ...
std::string_view kind_name(const NodeDescription& node);

/// A board has a chip whose state can be saved.
template <class Kind>
inline constexpr bool is_board = std::is_same_v<Kind, MainBoard> || std::is_same_v<Kind, rab::RabSpec> ||
                                 std::is_same_v<Kind, tam::TamSpec>;
bool has_board(const NodeDescription& node);

/// What all boards have, in the description of one of them; a TAM has no file for its memory.
struct BoardFields {
    std::string& name;
    std::string& firmware;
    std::uint64_t& seed;
    std::string& log;
    std::string* nvm;  ///< null: the kind has none
};
/// Of a node with has_board().
BoardFields board_fields(NodeDescription& node);

/// Without the files that a board writes: one that is only looked at leaves nothing on disk.
NodeDescription without_files(NodeDescription node);

/// As text for the node's process, and back. Throws InputError for what is no description.
std::string encode(const NodeDescription& node);
NodeDescription decode(std::string_view text);

/// What is compared, with the kind; faults are not among it.
JsonValue compared(const NodeDescription& node, Comparison comparison);

}  // namespace puckloop::tools
