#pragma once

namespace puckloop::tools {

class Command;

/// Adds `rab` to the command `trace`.
void declare_trace_rab(Command& trace);

}  // namespace puckloop::tools
