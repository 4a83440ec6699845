#pragma once
// `run --stats NODE`: a board of a run whose chip is looked at, instruction by instruction, from power-up to
// the end. What was found is "stats" of the node in report.json.

#include "cosim/core/stateful_node.h"

#include <memory>
#include <string>

namespace puckloop::tools {

/// `board` runs the image in `firmware`, whose names the report uses. Throws InputError: the file cannot be
/// read.
std::unique_ptr<cosim::StatefulNode> make_profiled(std::unique_ptr<cosim::StatefulNode> board,
                                                   const std::string& firmware);

}  // namespace puckloop::tools
