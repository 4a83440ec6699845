#pragma once
// What the parts of a run's set-up share.

#include "cosim/core/signal_info.h"
#include "run/description/run_request.h"
#include "run/description/run_setup.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Between a module's microcontroller and its transceiver, a computer and its network, each way. More than
/// nothing, so that neither waits for the other where both are due at the same time.
inline constexpr cosim::Time kTransfer = cosim::kMicrosecond;

/// Names by id, for traces, and ids by name, for the world.
std::vector<std::string> names_of(std::span<const cosim::SignalInfo> signals);
std::map<std::string, std::uint16_t> ids_of(std::span<const cosim::SignalInfo> signals);

/// "robot0.pic.log" in the results folder.
std::string log_of(const RunSetup& setup, const std::string& node);

/// A node that any thread may advance.
void add_free(RunSetup& setup, const std::string& name, NodeKind spec);

/// Node and link `name`: what the scenario plugs into a board's UART. No frame on the link comes faster than
/// at `nominal_baud`. Throws InputError.
void add_outside(RunSetup& setup, const std::string& name, const std::string& end, double baud,
                 const cosim::PortRef& board, double nominal_baud, const RunRequest& request);

}  // namespace puckloop::tools
