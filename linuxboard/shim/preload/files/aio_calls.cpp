// POSIX asynchronous reads and writes. The C library's own have threads that wait in the host, outside of
// simulated time; here each operation is a thread of the program.

#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/board_clock.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/time/clocks.h"

#include <aio.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <list>
#include <memory>

using namespace puckloop::shim;

namespace {
const char operation_key = 0;  // parked on: an operation has ended

struct Batch {
    int left = 0;
    sigevent notice{};
};

struct Operation {
    aiocb* block;
    int kind;  // LIO_READ, LIO_WRITE, or kSync, kDataSync
    std::shared_ptr<Batch> batch{};
};
constexpr int kSync = 100, kDataSync = 101;

std::list<const aiocb*>& under_way() {
    static auto* const all = new std::list<const aiocb*>;
    return *all;
}

void give_notice(const sigevent& notice) {
    if (notice.sigev_notify == SIGEV_SIGNAL)
        sigqueue(getpid(), notice.sigev_signo, notice.sigev_value);
    else if (notice.sigev_notify == SIGEV_THREAD && notice.sigev_notify_function != nullptr)
        notice.sigev_notify_function(notice.sigev_value);
}

/// What has no positions is read and written where it is, as in the C library.
ssize_t carry_out(const Operation& operation) {
    const aiocb& block = *operation.block;
    void* const buffer = const_cast<void*>(block.aio_buf);
    ssize_t result = -1;
    switch (operation.kind) {
    case LIO_READ:
        result = pread(block.aio_fildes, buffer, block.aio_nbytes, block.aio_offset);
        return result < 0 && errno == ESPIPE ? read(block.aio_fildes, buffer, block.aio_nbytes) : result;
    case LIO_WRITE:
        result = pwrite(block.aio_fildes, buffer, block.aio_nbytes, block.aio_offset);
        return result < 0 && errno == ESPIPE ? write(block.aio_fildes, buffer, block.aio_nbytes) : result;
    case kSync:
        return fsync(block.aio_fildes);
    default:
        return fdatasync(block.aio_fildes);
    }
}

void* perform(void* argument) {
    const std::unique_ptr<Operation> operation(static_cast<Operation*>(argument));
    const ssize_t result = carry_out(*operation);
    aiocb& block = *operation->block;
    const int error = result < 0 ? errno : 0;
    const sigevent notice = block.aio_sigevent;
    under_way().remove(&block);
    block.__return_value = result;
    block.__error_code = error;
    wake(&operation_key, INT_MAX);
    give_notice(notice);
    if (operation->batch && --operation->batch->left == 0) give_notice(operation->batch->notice);
    return nullptr;
}

bool refuse_block(aiocb& block, int error) {
    block.__error_code = errno = error;
    block.__return_value = -1;
    return false;
}

bool begin(aiocb* block, int kind, const std::shared_ptr<Batch>& batch = nullptr) {
    constexpr int kMostDelta = 20;  // AIO_PRIO_DELTA_MAX
    if (block->aio_reqprio < 0 || block->aio_reqprio > kMostDelta) return refuse_block(*block, EINVAL);
    block->__error_code = EINPROGRESS;
    block->__return_value = 0;
    auto operation = std::make_unique<Operation>(Operation{block, kind, batch});
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
    pthread_t thread;
    under_way().push_back(block);
    const int error = pthread_create(&thread, &attributes, perform, operation.get());
    pthread_attr_destroy(&attributes);
    if (error != 0) {
        under_way().remove(block);
        return refuse_block(*block, EAGAIN);
    }
    operation.release();
    return true;
}

/// 0, or -1 with EAGAIN at the deadline or EINTR.
template <typename Done>
int await(Time deadline, Done done) {
    charge(page().charges.sync);
    while (!done()) {
        if (now() >= deadline) return fail(EAGAIN);
        WaitOptions options;
        options.deadline = deadline;
        options.interruptible = true;
        options.cancellable = true;
        if (park(&operation_key, options) == Wake::Signal) return fail(EINTR);
    }
    return 0;
}

bool is_over(const aiocb* block) {
    return block->__error_code != EINPROGRESS;
}
}  // namespace

SHIM_EXPORT int aio_read(aiocb* block) noexcept {
    if (!active()) return REAL(aio_read)(block);
    return begin(block, LIO_READ) ? 0 : -1;
}

SHIM_EXPORT int aio_write(aiocb* block) noexcept {
    if (!active()) return REAL(aio_write)(block);
    return begin(block, LIO_WRITE) ? 0 : -1;
}

SHIM_EXPORT int aio_fsync(int operation, aiocb* block) noexcept {
    if (!active()) return REAL(aio_fsync)(operation, block);
    if (operation != O_SYNC && operation != O_DSYNC) return fail(EINVAL);
    return begin(block, operation == O_SYNC ? kSync : kDataSync) ? 0 : -1;
}

SHIM_EXPORT int aio_suspend(const aiocb* const list[], int count, const timespec* timeout) {
    if (!active()) return REAL(aio_suspend)(list, count, timeout);
    mark_call("aio_suspend");
    if (count < 0 || (timeout != nullptr && !is_valid(*timeout))) return fail(EINVAL);
    const Time deadline = timeout == nullptr ? kNever : time_after(from_timespec(*timeout));
    return await(deadline, [&] {
        bool any = false;
        for (int i = 0; i < count; ++i) {
            if (list[i] == nullptr) continue;
            if (is_over(list[i])) return true;
            any = true;
        }
        return !any;
    });
}

/// An operation that has begun goes on, as in Linux.
SHIM_EXPORT int aio_cancel(int fd, aiocb* block) noexcept {
    if (!active()) return REAL(aio_cancel)(fd, block);
    charge(page().charges.sync);
    if (fcntl(fd, F_GETFL) < 0) return fail(EBADF);
    if (block != nullptr && block->aio_fildes != fd) return fail(EINVAL);
    const auto& all = under_way();
    const bool any = std::any_of(all.begin(), all.end(), [&](const aiocb* one) {
        return block != nullptr ? one == block : one->aio_fildes == fd;
    });
    return any ? AIO_NOTCANCELED : AIO_ALLDONE;
}

SHIM_EXPORT int lio_listio(int mode, aiocb* const list[], int count, sigevent* notice) noexcept {
    if (!active()) return REAL(lio_listio)(mode, list, count, notice);
    mark_call("lio_listio");
    if ((mode != LIO_WAIT && mode != LIO_NOWAIT) || count < 0) return fail(EINVAL);
    const auto batch = std::make_shared<Batch>();
    batch->notice.sigev_notify = SIGEV_NONE;
    if (mode == LIO_NOWAIT && notice != nullptr) batch->notice = *notice;
    const auto is_asked = [](const aiocb* block) {
        return block != nullptr && (block->aio_lio_opcode == LIO_READ || block->aio_lio_opcode == LIO_WRITE);
    };
    batch->left = static_cast<int>(std::count_if(list, list + count, is_asked));
    if (batch->left == 0) give_notice(batch->notice);
    bool all_begun = true;
    for (int i = 0; i < count; ++i) {
        if (!is_asked(list[i]) || begin(list[i], list[i]->aio_lio_opcode, batch)) continue;
        all_begun = false;
        if (--batch->left == 0) give_notice(batch->notice);
    }
    const auto over = [&] {
        return std::all_of(list, list + count,
                           [&](const aiocb* block) { return !is_asked(block) || is_over(block); });
    };
    if (mode == LIO_WAIT && await(kNever, over) != 0) return -1;
    const bool failed = mode == LIO_WAIT && std::any_of(list, list + count, [&](const aiocb* block) {
                            return is_asked(block) && block->__error_code != 0;
                        });
    if (all_begun && !failed) return 0;
    return fail(EIO);
}

// On machines of 64 bits the calls of both sizes are the same.
SHIM_EXPORT int aio_read64(aiocb64* block) noexcept {
    return aio_read(reinterpret_cast<aiocb*>(block));
}
SHIM_EXPORT int aio_write64(aiocb64* block) noexcept {
    return aio_write(reinterpret_cast<aiocb*>(block));
}
SHIM_EXPORT int aio_fsync64(int operation, aiocb64* block) noexcept {
    return aio_fsync(operation, reinterpret_cast<aiocb*>(block));
}
SHIM_EXPORT int aio_suspend64(const aiocb64* const list[], int count, const timespec* timeout) {
    return aio_suspend(reinterpret_cast<const aiocb* const*>(list), count, timeout);
}
SHIM_EXPORT int aio_cancel64(int fd, aiocb64* block) noexcept {
    return aio_cancel(fd, reinterpret_cast<aiocb*>(block));
}
SHIM_EXPORT int lio_listio64(int mode, aiocb64* const list[], int count, sigevent* notice) noexcept {
    return lio_listio(mode, reinterpret_cast<aiocb* const*>(list), count, notice);
}
