#pragma once
// Decides which candidates suffer a fault. The same for a byte, a phase of a bus, an interrupt or a sample.

#include "base/random.h"
#include "cosim/core/time.h"
#include "cosim/faults/spec/fault_spec.h"

#include <cstdint>
#include <string_view>

namespace puckloop::cosim {

class Trigger {
  public:
    /// `random` is the fault's own stream (fault_stream()); what the kind draws comes from it too.
    Trigger(const FaultSpec& spec, RandomStream random);

    /// Whether the candidate that begins at `time` suffers. To be asked once for each that matches, in the
    /// order of time. Window, then skip and every, then burst or probability; counts what it lets fire.
    bool fires(Time time);
    /// Whether `time` is in the window: for what holds all the time.
    bool open(Time time) const { return time >= begin_ && time < end_; }
    /// It has fired as often as it may.
    bool spent() const { return state_.fired >= count_; }

    /// For what happens at instants: the first one at or after `time`, kNever if there is none. It fires if
    /// fires() is true.
    Time instant(Time time) const;

    Time begin() const { return begin_; }
    Time end() const { return end_; }
    std::uint64_t fired() const { return state_.fired; }
    RandomStream& random() { return random_; }

    /// What changes in a run (base/states/archive.h).
    template <class Archive>
    void state(Archive& archive) {
        archive(state_.matched, state_.fired, state_.bad, random_);
    }

  private:
    bool drawn();

    double probability_;
    std::uint64_t count_, skip_, every_;
    Time begin_, end_, period_;
    std::optional<Burst> burst_;
    struct {
        std::uint64_t matched = 0, fired = 0;
        bool bad = false;
    } state_;
    RandomStream random_;
};

/// The random stream of the fault that is number `index` of the run's list. `use` distinguishes several of
/// one fault apart: a direction of a link.
RandomStream fault_stream(const FaultSpec& spec, std::uint64_t seed, std::size_t index, int use = 0);

}  // namespace puckloop::cosim
