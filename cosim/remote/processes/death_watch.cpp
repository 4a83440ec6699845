#include "cosim/remote/processes/death_watch.h"

#include "base/error.h"
#include "cosim/core/process_name.h"

#include <fmt/format.h>

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>

namespace puckloop::cosim {

DeathWatch::DeathWatch(std::function<void()> noticed)
    : noticed_(std::move(noticed)), events_(epoll_create1(EPOLL_CLOEXEC)), ending_(eventfd(0, EFD_CLOEXEC)) {
    epoll_event event{EPOLLIN, {.ptr = nullptr}};
    if (events_ < 0 || ending_ < 0 || epoll_ctl(events_, EPOLL_CTL_ADD, ending_, &event) != 0)
        throw RunError(fmt::format("cannot watch processes: {}", std::strerror(errno)));
    // Signals are for the thread that conducts.
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    thread_ = std::thread([this] { serve(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

DeathWatch::~DeathWatch() {
    const std::uint64_t one = 1;
    if (write(ending_, &one, sizeof one) == sizeof one) thread_.join();
    for (const Watched& watched : watched_)
        close(watched.descriptor);
    close(ending_);
    close(events_);
}

const std::atomic<bool>* DeathWatch::watch(pid_t process) {
    const int descriptor = static_cast<int>(syscall(SYS_pidfd_open, process, 0));
    if (descriptor < 0) return nullptr;
    Watched& watched = watched_.emplace_back();
    watched.descriptor = descriptor;
    epoll_event event{EPOLLIN | EPOLLONESHOT, {.ptr = &watched}};
    return epoll_ctl(events_, EPOLL_CTL_ADD, descriptor, &event) == 0 ? &watched.ended : nullptr;
}

void DeathWatch::serve() {
    name_thread("death watch");
    while (true) {
        epoll_event event{};
        if (epoll_wait(events_, &event, 1, -1) != 1) continue;
        auto* const watched = static_cast<Watched*>(event.data.ptr);
        if (watched == nullptr) return;
        watched->ended.store(true, std::memory_order_release);
        noticed_();
    }
}

}  // namespace puckloop::cosim
