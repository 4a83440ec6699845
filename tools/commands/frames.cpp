// puckloop frames: wire formats, encoded, read and checked without running anything.

#include "tools/commands/frames.h"

#include "tools/cli/command.h"
#include "tools/commands.h"

namespace puckloop::tools {

void declare_frames(Command& app, int& status) {
    Command* frames = app.add_subcommand("frames", "Encode, decode and check wire formats");
    frames->require_subcommand(1);
    declare_rab_frames(*frames, status);
    declare_epuck_frames(*frames, status);
    declare_xbee_frames(*frames, status);
    declare_ircom_frames(*frames, status);
}

}  // namespace puckloop::tools
