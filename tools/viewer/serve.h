#pragma once
// The page over a run that goes on: of `view FOLDER`, and of `run --view`.

#include "view/server/http_server.h"

#include <string>

namespace puckloop::tools {

/// Prints the page's address with `rest` behind it, serves until Ctrl-C, prints how many requests came.
void serve_until_interrupted(view::HttpServer& server, const std::string& rest = {});

/// Drives the run in `folder`, which waits for its client, and serves its page on `port` (0: any that is
/// free) until Ctrl-C, which ends the run. `opens`: in the user's browser, where there is a display. Throws
/// InputError.
void serve_live(const std::string& folder, int port, bool opens = false);

}  // namespace puckloop::tools
