#pragma once
// One node of a recorded run, executed alone: it gets what it got then, at the same times, and what it sends
// is compared with what it sent.

#include "cosim/core/link.h"
#include "cosim/core/node.h"
#include "replay/comparison.h"
#include "traces/recorded_trace.h"

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace puckloop::tools {

struct ReplayResult {
    std::uint64_t received = 0;                  ///< messages handed to the node
    std::uint64_t equal = 0;                     ///< messages sent as recorded
    cosim::Time until = 0;                       ///< how far the node was executed
    std::optional<ReplayDifference> difference;  ///< where it ended, if there was one
    std::set<std::string> links;                 ///< those of the node of which the record has rows
};

/// What happens to be looked at while the node is executed, from `from` on.
struct ReplayWatch {
    cosim::Time from = 0;
    /// When the node is to stand still next, after `now`.
    std::function<cosim::Time(cosim::Time now)> next;
    /// It stands still: all before `now` has happened.
    std::function<void(cosim::Time now)> look;
};

/// How the recorded run went on beside its messages, and what is looked at.
struct ReplayOptions {
    /// When its nodes were asked to end (Node::wind_up), if they were.
    std::optional<cosim::Time> wind_up{};
    const ReplayWatch* watch = nullptr;
    /// No message can be later: the run had ended.
    cosim::Time end = cosim::kNever;
    std::set<std::string> links_with_faults{};  ///< on which the record may have messages late
};

/// `record` must hold every message of the node's links (a run's record.csv). Throws InputError for a record
/// that cannot be read or holds nothing of the node.
ReplayResult replay(cosim::Node& node, const std::vector<cosim::LinkSpec>& links, const RecordedTrace& record,
                    const ReplayOptions& options = {});

}  // namespace puckloop::tools
