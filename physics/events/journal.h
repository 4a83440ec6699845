#pragma once
// What was done to a world: as [[event]] tables that repeat it, for the run's report, and what never came.

#include "physics/events/event.h"

#include <cstdio>
#include <memory>

namespace puckloop::physics {

/// To the microsecond, as people write it.
inline double in_seconds(cosim::Time time) {
    return static_cast<double>(time / cosim::kMicrosecond) / 1e6;
}
/// "12.5 s": exact, to the microsecond.
std::string seconds_text(cosim::Time time);

class Journal {
  public:
    /// Opens plan.journal. Throws RunError. `plan` must outlive it.
    explicit Journal(const EventPlan& plan);

    /// `event` is its number in the plan, or kLive.
    void done(std::size_t event, cosim::Time time, const Action& action);
    void refused(std::size_t event, cosim::Time time, const Action& action, const std::string& why);
    std::uint64_t times_done(std::size_t event) const { return done_[event]; }

    static constexpr std::size_t kLive = ~std::size_t{0};

    struct Entry {
        std::string event;  ///< its name; "command" for one that came in while the run was on
        cosim::Time time = 0;
        std::string command, refused;
    };
    const std::vector<Entry>& entries() const { return entries_; }
    /// One line for each event of the plan that was refused or never came.
    std::vector<std::string> warnings() const;

  private:
    void write(const std::string& text);
    std::string name_of(std::size_t event) const;

    struct Closer {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    const EventPlan& plan_;
    std::unique_ptr<std::FILE, Closer> file_;
    std::vector<std::uint64_t> done_, refused_;
    std::vector<Entry> entries_;
};

}  // namespace puckloop::physics
