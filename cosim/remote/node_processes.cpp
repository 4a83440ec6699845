#include "cosim/remote/node_processes.h"

namespace puckloop::cosim {

NodeProcesses::NodeProcesses()
    : memory_(SharedByRun::kName, sizeof(SharedByRun)),
      shared_(*reinterpret_cast<SharedByRun*>(memory_.data())),
      bell_(shared_.conductor, shared_.busy),
      deaths_([this] { bell_.ring(true); }) {
    shared_.busy.processes.fetch_add(1);  // the conductor
}

void NodeProcesses::await_answers(std::uint32_t seen, std::size_t out) {
    const std::size_t enough = out < cores_ ? 1 : out - cores_ + 1;
    bell_.wait(seen, static_cast<std::uint32_t>(enough), kWaitSlice);
}

}  // namespace puckloop::cosim
