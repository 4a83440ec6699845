#pragma once
// A whole run as it was at one instant, from which it can go on as if it had never stopped
// (docs/snapshots.md).
//
// Nodes with a state (cosim/core/stateful_node.h) have it here; any other node is executed again, by itself
// and on what it received, and must send what it sent. So a Linux program, of which no part can be saved,
// is part of a snapshot too.

#include "cosim/core/node.h"
#include "cosim/core/time.h"
#include "cosim/schedule/wire_record.h"
#include "cosim/trace/link_stats.h"
#include "cosim/trace/trace.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// Rises whenever what a snapshot holds changes; what nodes list as their state is covered by the build.
inline constexpr std::uint32_t kSnapshotFormat = 1;

struct NodeSnapshot {
    std::string name;
    bool has_state = false;
    std::vector<std::uint8_t> state{};
    bool stop_seen = false;
};

/// A node's request to end the run that was heard already.
struct StopSnapshot {
    Stop stop;
    std::uint32_t node = 0;
};

struct RunSnapshot {
    std::string build;   ///< build_id() of the program that wrote it
    std::string origin;  ///< whose run it is: of no meaning here
    Time time = 0;       ///< nothing of this instant has happened yet
    std::vector<NodeSnapshot> nodes;
    std::vector<WireState> wires;  ///< of each link from a, then from b
    std::vector<LinkStats> stats;  ///< one a wire
    std::vector<TraceRecord> in_flight;
    std::vector<std::uint8_t> hash;           ///< the trace's, of all that was delivered before
    std::vector<StopSnapshot> stop_requests;  ///< of nodes that end the run together
    std::optional<StopSnapshot> stop;
    std::uint64_t unlinked = 0;
    std::string trace;  ///< what trace.csv held
};

std::vector<std::uint8_t> encode(const RunSnapshot& snapshot);
/// Throws InputError naming `name`: no snapshot, another format or build, cut short, damaged.
RunSnapshot decode_snapshot(std::span<const std::uint8_t> bytes, const std::string& name);

/// Throws InputError as decode_snapshot(), or if the file cannot be read.
RunSnapshot read_snapshot(const std::filesystem::path& path);
/// Written whole or not at all, mode 0600. Throws RunError.
void write_snapshot(const std::filesystem::path& path, const RunSnapshot& snapshot);

}  // namespace puckloop::cosim
