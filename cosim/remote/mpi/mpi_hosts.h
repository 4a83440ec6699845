#pragma once
// The ranks of an MPI job as hosts of a run's nodes; rank 0 is the conductor's.

#include "cosim/remote/mpi/message_passing.h"
#include "cosim/remote/mpi/patience.h"
#include "cosim/remote/node_hosts.h"

#include <memory>
#include <vector>

namespace puckloop::cosim {

/// What went to and fro, for the report.
struct MpiTraffic {
    std::uint64_t messages = 0;  ///< both ways
    std::uint64_t bytes = 0;
    std::uint64_t waits = 0;
    double waited_s = 0;  ///< wall time in which the conductor had nothing to do
};

class MpiHosts : public NodeHosts {
  public:
    /// Of `job`, whose rank 0 this is, and which outlives it.
    explicit MpiHosts(const MessagePassing& job);

    unsigned count() const override { return static_cast<unsigned>(job_.ranks()) - 1; }
    std::unique_ptr<NodeLine> line_to(unsigned host) override;
    void await_answers() override;

    /// Nodes are finished: the other ranks may end. False if one does not for `patience` of wall time.
    bool end(std::chrono::seconds patience);

    const MpiTraffic& traffic() const { return traffic_; }
    /// Median wall time of a message there and back to `host`, which serves no node yet, of 200; s.
    double round_trip_s(unsigned host);

    /// Processor time of the nodes on all hosts and of their programs that have ended, s. Between runs.
    double worked_s();

  private:
    class Line;
    void ask(unsigned host, int tag, std::span<const std::uint8_t> bytes);

    bool take_one();

    const MessagePassing& job_;
    std::vector<Line*> lines_;  ///< by tag; null once they are closed
    MpiTraffic traffic_;
    Patience patience_;
    Bytes bytes_;
};

}  // namespace puckloop::cosim
