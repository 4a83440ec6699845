#include "cosim/remote/mpi/message_passing.h"

#include "base/error.h"

#include <mpi.h>

#include <cstdlib>

namespace puckloop::cosim {

MessagePassing::MessagePassing(int& argc, char**& argv) {
    int level = 0;
    if (MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level) != MPI_SUCCESS)
        throw RunError("MPI does not start");
    if (level < MPI_THREAD_FUNNELED) throw RunError("this MPI allows no threads");
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
}

MessagePassing::~MessagePassing() {
    MPI_Finalize();
}

void MessagePassing::abort(int status) {
    MPI_Abort(MPI_COMM_WORLD, status);
    std::_Exit(status);
}

struct Outgoing::Request {
    MPI_Request request = MPI_REQUEST_NULL;
};

Outgoing::Outgoing() : request_(std::make_unique<Request>()) {}

Outgoing::~Outgoing() {
    MPI_Wait(&request_->request, MPI_STATUS_IGNORE);
}

void Outgoing::send(int rank, int tag, std::span<const std::uint8_t> bytes) {
    MPI_Wait(&request_->request, MPI_STATUS_IGNORE);
    bytes_.assign(bytes.begin(), bytes.end());
    MPI_Isend(bytes_.data(), static_cast<int>(bytes_.size()), MPI_BYTE, rank, tag, MPI_COMM_WORLD,
              &request_->request);
}

std::optional<Origin> take_message(Bytes& bytes) {
    int there = 0;
    MPI_Message message = MPI_MESSAGE_NULL;
    MPI_Status status;
    MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &message, &status);
    if (there == 0) return std::nullopt;
    int length = 0;
    MPI_Get_count(&status, MPI_BYTE, &length);
    bytes.resize(static_cast<std::size_t>(length));
    MPI_Mrecv(bytes.data(), length, MPI_BYTE, &message, MPI_STATUS_IGNORE);
    return Origin{status.MPI_SOURCE, status.MPI_TAG};
}

}  // namespace puckloop::cosim
