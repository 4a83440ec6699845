#pragma once
// `puckloop exec --view`: the board of the bench in a run of its own, with the page that drives it.

#include "bench/options.h"

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Options of `exec` that --view takes, by their long names.
const std::vector<std::string>& options_with_view();

/// Writes the scenario of the board, "out/exec_IMAGE.toml". `revision` and `errata` as the command line gave
/// them. Throws InputError for a chip without a board, and for ends that a page cannot have.
std::filesystem::path write_board_scenario(const exec::ExecOptions& options, const std::string& revision,
                                           const std::vector<std::string>& errata);

}  // namespace puckloop::tools
