#pragma once
// The boards of a run alone: what a run would cost if there were nothing between its processors.
//
// A run is recorded once: each board's memory images, and all that it received and when (cosim/resume). Then
// every board is made again and executed from power-up to the same instant in one single grant, its recorded
// inputs at hand, one board after the other in one thread. It executes the same instructions, which is
// checked: it must send what it sent in the run.

#include "cosim/resume/board_state.h"
#include "run/description/node_description.h"

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

struct RecordedBoard {
    NodeDescription description;  ///< of the node, without log and files of its own
    cosim::BoardState life;       ///< what it received and sent
};

struct Recording {
    double simulated_s = 0;
    std::vector<RecordedBoard> boards;
};

/// Runs `scenario` for so long, in this process. Throws InputError and RunError as a run does.
Recording record_boards(const std::filesystem::path& scenario, double simulated_s,
                        const std::filesystem::path& folder);

struct ReplayTiming {
    double wall_s = 0;  ///< of execution: boards are made and images loaded before
    double cpu_s = 0;   ///< the same in processor time, which other load on the machine changes little
    std::uint64_t instructions = 0;
    std::uint64_t cycles = 0;
};

/// Throws RunError naming the board if one sends anything else than in the run.
ReplayTiming replay_boards(const Recording& recording);

}  // namespace puckloop::tools
