#pragma once
// A few threads that share short pieces of work: nodes of one process that may advance side by side.
//
// A piece takes some microseconds, so that handing it over must cost less: threads that have nothing to do
// look again for a moment before they sleep. Where the machine has no core to spare for them, a thread may be
// put aside in the middle of a piece while everybody waits; after such a wait the caller works alone for a
// while.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace puckloop::cosim {

class Workers {
  public:
    using Work = std::function<void(std::size_t piece)>;

    /// `helpers`: threads besides the caller's; 0 is allowed.
    explicit Workers(unsigned helpers);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    /// Does pieces 0..count-1, each once, in any order, on any thread; returns when all are done. `work` must
    /// not throw. At most 65535 pieces.
    void run(std::size_t count, const Work& work);

  private:
    /// Takes the next piece, if there is one. False: nothing left.
    bool do_one();
    void help();
    void wait_for_all(std::size_t count);

    std::vector<std::thread> threads_;
    /// Round, number of pieces, next piece: a piece taken belongs to the round that is under way.
    std::atomic<std::uint64_t> ticket_{0};
    std::atomic<std::size_t> done_{0};
    std::atomic<bool> ending_{false};
    const Work* work_ = nullptr;
    std::uint32_t round_ = 0;
    int alone_ = 0;  ///< rounds to go without help
};

}  // namespace puckloop::cosim
