#pragma once
// A rank other than 0 of an MPI job: it serves nodes of a run until rank 0 has no more to say.

#include "cosim/remote/mpi/message_passing.h"
#include "cosim/schedule/node_handle.h"

namespace puckloop::cosim {

// Tags below the first node's.
inline constexpr int kEndTag = 0;   ///< rank 0 has no more to say
inline constexpr int kEchoTag = 1;  ///< to be sent back as it is
inline constexpr int kWorkTag = 2;  ///< answered with the processor time of its nodes and their programs, s
inline constexpr int kFirstNodeTag = 3;

/// Makes nodes with `factory`, advances them as granted, one after the other, and lets those whose programs
/// compute wait meanwhile. Errors of a node go to the conductor, which reports them.
void serve_rank(const NodeFactory& factory);

}  // namespace puckloop::cosim
