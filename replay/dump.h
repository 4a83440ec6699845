#pragma once
// The value change dump of a replay: the lines of the node, and the values that were watched.

#include "replay/watch.h"
#include "traces/recorded_trace.h"

#include <string>

namespace puckloop::tools {

/// `lines` selects the node's links and the time; the values stand under `node`. `watch` may be null. Throws
/// RunError when `path` cannot be written.
void write_dump(const std::string& path, const RecordedTrace& lines, const std::string& node, Watch* watch);

}  // namespace puckloop::tools
