#include "cosim/remote/processes/node_processes.h"

#include "cosim/remote/node_line.h"

namespace puckloop::cosim {

NodeProcesses::NodeProcesses()
    : memory_(SharedByRun::kName, sizeof(SharedByRun)),
      shared_(*reinterpret_cast<SharedByRun*>(memory_.data())),
      bell_(shared_.conductor, shared_.busy),
      choice_(shared_.busy),
      deaths_([this] { bell_.ring(true); }) {
    shared_.busy.processes.fetch_add(1);  // the conductor
}

void NodeProcesses::await_answers(std::uint32_t seen, std::size_t out) {
    const std::size_t cores = shared_.busy.core.load(std::memory_order_relaxed) == kAnyCore ? cores_ : 1;
    const std::size_t enough = out < cores ? 1 : out - cores + 1;
    bell_.wait(seen, static_cast<std::uint32_t>(enough), kWaitSlice);
}

}  // namespace puckloop::cosim
