#pragma once
// Finite-state machines as text, as automatic design methods of the field write them:
//
//   --nstates 2 --s0 0 --rwm0 5 --n0 1 --n0x0 0 --c0x0 0 --p0x0 1 --s1 1 --n1 1 --n1x0 0 --c1x0 5 --p1x0 0.05
//
// State I has a behaviour --sI and its parameter, and --nI transitions. Transition J of it leads to --nIxJ,
// counted among the other states (state I left out), under the condition --cIxJ with --pIxJ and --wIxJ.

#include <string_view>
#include <vector>

namespace puckloop::control {

struct MachineCondition {
    enum class Kind { Black, Grey, White, Neighbours, FewNeighbours, Chance };
    Kind kind = Kind::Chance;
    int target = 0;  ///< state
    double p = 0;    ///< chance a step, 0..1; of the two about neighbours their number at chance 1/2
    double w = 0;    ///< of those two: how steep the chance is about that number
};

struct MachineState {
    enum class Kind { Walk, Stop, ToLight, FromLight, Attraction, Repulsion };
    Kind kind = Kind::Stop;
    /// Walk: longest turn in steps; Attraction and Repulsion: weight of the neighbours; else unused.
    double parameter = 0;
    std::vector<MachineCondition> conditions{};
};

/// The machine begins in the first state. Throws std::runtime_error that names the word and what was
/// expected there.
std::vector<MachineState> parse_machine(std::string_view text);

}  // namespace puckloop::control
