#pragma once
// A few threads that take pieces of work from the caller's: nodes of one process that advance beside each
// other and beside the caller, who hands out more as pieces come back.
//
// A piece takes some microseconds, so that handing it over must cost less: threads that have nothing to do
// look again for a moment before they sleep. Where the machine has no core to spare for them, a thread may be
// put aside in the middle of a piece while the caller waits; after such a wait the caller should work alone
// for a while.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <thread>
#include <vector>

namespace puckloop::cosim {

class Workers {
  public:
    using Work = std::function<void(std::size_t piece)>;

    /// `helpers`: threads besides the caller's; 0 is allowed. `pieces`: how many there are at most at a time.
    /// `work` must not throw.
    Workers(unsigned helpers, std::size_t pieces, Work work);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    /// All calls are the caller's thread's. Hands out a piece; `wake`: a helper that sleeps is woken for it.
    void submit(std::size_t piece, bool wake);
    /// Does a piece that nobody has begun. False: there is none.
    bool do_one();
    /// Appends the pieces that have been done since.
    void take_done(std::vector<std::size_t>& done);
    /// Waits until there is one to take, or until `other()`, asked again and again, is true. Something must
    /// be under way.
    void wait(const std::function<bool()>& other = [] { return false; });
    /// Waits until nobody works any more; what was not begun is left out, what was done is forgotten.
    void stop();

    unsigned helpers() const { return static_cast<unsigned>(threads_.size()); }
    /// So many have been handed out and not been begun.
    std::size_t waiting() const { return handed_out_.load() - begun_.load(); }
    /// So many have been handed out and not been taken.
    std::size_t under_way() const { return under_way_; }
    /// So many helpers look for work.
    unsigned awake() const;
    /// False for a while after a helper was put aside, and while they rest.
    bool available() {
        if (alone_ > 0) --alone_;
        return !threads_.empty() && alone_ == 0 && !resting_;
    }
    /// Whether helpers are to be left alone for now, by whoever hands work out.
    void set_resting(bool resting) { resting_ = resting; }
    bool resting() const { return resting_; }

  private:
    bool has_work() const;
    bool is_done() const;
    void help(std::atomic<int>& asleep);
    void wake_one();

    Work work_;
    std::vector<std::thread> threads_;
    std::vector<std::atomic<std::size_t>> pieces_;  ///< ring: those to be begun are [begun_, handed_out_)
    std::vector<std::atomic<std::size_t>> done_;    ///< ring: number + 1 of a piece that is done, 0: none
    std::atomic<std::uint32_t> handed_out_{0};
    std::atomic<std::uint32_t> begun_{0};
    std::atomic<std::uint32_t> finished_{0};
    std::uint32_t taken_ = 0;
    std::size_t under_way_ = 0;
    std::deque<std::atomic<int>> asleep_;  ///< by helper: 1 until it is woken
    std::atomic<bool> ending_{false};
    bool resting_ = false;
    int alone_ = 0;  ///< calls of available() until helpers are tried again
};

}  // namespace puckloop::cosim
