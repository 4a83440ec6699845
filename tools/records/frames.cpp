// puckloop frames: wire formats, encoded, read and checked without running anything.

#include "tools/records/frames.h"

#include "base/error.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"
#include "tools/records/records.h"

#include <iostream>
#include <utility>

namespace puckloop::tools {

void flush_output() {
    std::cout.flush();
    if (!std::cout) throw RunError("standard output: cannot write");
}

void declare_action(Command& command, bool& json, std::function<void()> act) {
    command.add_flag("--json", json, "one JSON object a line");
    command.callback([act = std::move(act)] {
        act();
        flush_output();
    });
}

void declare_frames(Command& app, int& status) {
    Command* frames = app.add_subcommand("frames", about("frames"));
    frames->require_subcommand(1);
    declare_rab_frames(*frames, status);
    declare_epuck_frames(*frames, status);
    declare_xbee_frames(*frames, status);
    declare_ircom_frames(*frames, status);
}

}  // namespace puckloop::tools
