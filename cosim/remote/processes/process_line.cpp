#include "cosim/remote/processes/process_line.h"

#include "cosim/core/process_name.h"
#include "cosim/remote/processes/child_process.h"
#include "cosim/remote/processes/ring_stream.h"

#include <fmt/format.h>

#include <array>
#include <atomic>

namespace puckloop::cosim {

namespace {

// To reap a process that has ended, or is about to.
constexpr std::chrono::milliseconds kEndPatience{2000};

class ProcessLine : public NodeLine {
  public:
    ProcessLine(NodeProcesses& processes, const std::string& name, const std::vector<std::string>& command)
        : memory_(SharedWithNode::kName, sizeof(SharedWithNode)),
          shared_(*reinterpret_cast<SharedWithNode*>(memory_.data())),
          bell_(shared_.node, processes.busy()),
          stream_(shared_.from_node, shared_.to_node, processes.bell(), bell_) {
        child_ = std::make_unique<ChildProcess>(command, std::string(kNodeTitle) + name,
                                                std::array{memory_.descriptor(), processes.descriptor()});
        memory_.close_descriptor();
        processes.busy().processes.fetch_add(1);
        ended_ = processes.deaths().watch(child_->id());
    }

    bool send(std::span<const std::uint8_t> bytes, std::chrono::nanoseconds limit) override {
        return stream_.send(bytes, limit);
    }
    bool receive(std::chrono::nanoseconds limit) override { return stream_.receive(limit); }
    std::span<const std::uint8_t> body() const override { return stream_.body(); }

    bool ended() override {
        return ended_ ? ended_->load(std::memory_order_acquire)
                      : child_->ended(std::chrono::milliseconds::zero());
    }
    std::string ending() override {
        child_->ended(kEndPatience);
        return child_->ending();
    }
    void close() override { child_->ended(kEndPatience); }

    std::string place() const override { return fmt::format("process {}", child_->id()); }
    int process() const override { return static_cast<int>(child_->id()); }

  private:
    SharedMemory memory_;
    SharedWithNode& shared_;
    Bell bell_;
    RingStream stream_;
    std::unique_ptr<ChildProcess> child_;
    const std::atomic<bool>* ended_ = nullptr;  ///< DeathWatch
};

}  // namespace

std::unique_ptr<NodeLine> start_node_process(NodeProcesses& processes, const std::string& name,
                                             const std::vector<std::string>& command) {
    return std::make_unique<ProcessLine>(processes, name, command);
}

}  // namespace puckloop::cosim
