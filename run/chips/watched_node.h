#pragma once
// A board of a run whose chip is read at stated instants, until it holds what is expected. What was read is
// "watches" of the node in report.json, in the order of the watches.

#include "cosim/core/stateful_node.h"
#include "run/chips/chip_watch.h"

#include <memory>
#include <string>
#include <vector>

namespace puckloop::tools {

/// `board` runs the image in `firmware`, whose names the watches use. Throws InputError with a watch's file
/// and place: no comparison, or of something that the chip has not.
std::unique_ptr<cosim::StatefulNode> make_watched(std::unique_ptr<cosim::StatefulNode> board,
                                                  const std::string& firmware,
                                                  const std::vector<ChipWatch>& watches);

}  // namespace puckloop::tools
