#pragma once
// `puckloop dap`: the debugger as a debug adapter, for editors.
// Source: "Debug Adapter Protocol Specification", 1.6x.

namespace puckloop::exec::debugger {

/// Serves one session; 0 once the editor has disconnected or closed `in`. Throws InputError for bytes that
/// are no messages of the protocol.
int serve_dap(int in, int out);

}  // namespace puckloop::exec::debugger
