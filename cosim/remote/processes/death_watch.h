#pragma once
// Notices at once when a child process ends, beside whatever else this process waits for.

#include <atomic>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

#include <sys/types.h>

namespace puckloop::cosim {

class DeathWatch {
  public:
    /// `noticed` is called from a thread of this object after each death. Throws RunError.
    explicit DeathWatch(std::function<void()> noticed);
    ~DeathWatch();
    DeathWatch(const DeathWatch&) = delete;
    DeathWatch& operator=(const DeathWatch&) = delete;

    /// Set once child `process`, not yet reaped, has ended; lives as long as this object. Null where the
    /// kernel has no descriptors of processes.
    const std::atomic<bool>* watch(pid_t process);

  private:
    struct Watched {
        int descriptor = -1;
        std::atomic<bool> ended{false};
    };

    void serve();

    std::function<void()> noticed_;
    int events_ = -1;
    int ending_ = -1;
    std::deque<Watched> watched_;
    std::thread thread_;
};

}  // namespace puckloop::cosim
