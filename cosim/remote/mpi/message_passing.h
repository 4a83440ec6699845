#pragma once
// What is used of MPI: ranks of one job, and whole messages between them, none of which anybody waits for.

#include "cosim/core/codec.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace puckloop::cosim {

/// This process's part in an MPI job. One a process; made and used by the main thread alone.
class MessagePassing {
  public:
    /// A process that no mpirun started is a job of one rank. Throws RunError.
    MessagePassing(int& argc, char**& argv);
    /// Waits for all ranks to come to this.
    ~MessagePassing();
    MessagePassing(const MessagePassing&) = delete;
    MessagePassing& operator=(const MessagePassing&) = delete;

    int rank() const { return rank_; }
    int ranks() const { return ranks_; }
    /// Ends all ranks at once.
    [[noreturn]] void abort(int status);

  private:
    int rank_ = 0;
    int ranks_ = 1;
};

/// A message on its way out, which keeps its bytes until they are taken.
class Outgoing {
  public:
    Outgoing();
    ~Outgoing();
    Outgoing(const Outgoing&) = delete;
    Outgoing& operator=(const Outgoing&) = delete;

    /// Waits until the one before is taken. `tag` >= 0.
    void send(int rank, int tag, std::span<const std::uint8_t> bytes);

  private:
    struct Request;
    std::unique_ptr<Request> request_;
    Bytes bytes_;
};

/// Where a message came from.
struct Origin {
    int rank = 0;
    int tag = 0;
};

/// The next message from anybody, into `bytes`; nothing if none has come.
std::optional<Origin> take_message(Bytes& bytes);

}  // namespace puckloop::cosim
