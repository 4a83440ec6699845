#pragma once
// The subcommands of `puckloop trace`, one file each, and the options that they share.

namespace puckloop::tools {

class Command;
struct TraceSelection;

void declare_trace_decode(Command& trace);
void declare_trace_export(Command& trace);
void declare_trace_rab(Command& trace);

/// --link, --from-node, --kind, --from and --to.
void add_selection(Command& command, TraceSelection& selection);

}  // namespace puckloop::tools
