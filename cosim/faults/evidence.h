#pragma once
// That a fault fired: how often, when and on what. The same in every placement.

#include "cosim/core/time.h"
#include "cosim/faults/spec/fault_spec.h"

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::cosim {

struct Firing {
    Time time = 0;  ///< the frame's start, or when it happened
    std::uint64_t index =
        0;               ///< of the frame among those sent in its direction, from 0; of a node: as it states
    std::string from{};  ///< who sent it; for a node's fault empty
    std::string what{};  ///< "0x41" for a byte, ...: one short text without commas

    friend bool operator==(const Firing&, const Firing&) = default;
};

class Evidence {
  public:
    static constexpr std::size_t kMostKept = 1000;  ///< firings that are kept with all details: the first

    /// `known` is when, in simulated time, it is certain in every placement that it happened: for a message
    /// its delivery had there been no fault. Does not fall behind an earlier one by more than kMemory.
    void fire(Firing firing, Time known);
    /// One that is certain from the beginning, however far ahead. Not part of a saved state.
    void foresee(Firing firing, Time known);

    std::uint64_t fired(Time end = kNever) const;  ///< those known before `end`
    std::vector<Firing> firings(Time end = kNever) const;
    std::optional<Time> last(Time end = kNever) const;

    template <class Archive>
    void state(Archive& archive) {
        archive(fired_, last_, kept_, late_);
    }

  private:
    struct Kept {
        Firing firing;
        Time known = 0;
        template <class Archive>
        void state(Archive& archive) {
            archive(firing.time, firing.index, firing.from, firing.what, known);
        }
    };
    struct Late {
        Time time = 0, known = 0;
        template <class Archive>
        void state(Archive& archive) {
            archive(time, known);
        }
    };
    /// No node is further ahead of the end of a run (RunOptions::stop_latency).
    static constexpr Time kMemory = kSecond;

    std::uint64_t fired_ = 0;
    Time last_ = 0;           ///< of those no longer in `late_`
    std::vector<Kept> kept_;  ///< the first
    std::deque<Late> late_;   ///< the newest, which may turn out to lie beyond the end of the run
    std::vector<Kept> foreseen_;
};

/// What a run reports of one fault.
struct FaultReport {
    std::string name;
    std::string text;  ///< "drop on robot0.uart from robot0.pic"
    std::string kind;
    std::string place;  ///< link or node
    bool may_not_fire = false;
    std::uint64_t fired = 0;
    std::optional<Time> last{};
    std::vector<Firing> firings{};  ///< the first kMostKept, in the order of time

    bool failed_to_fire() const { return fired == 0 && !may_not_fire; }
    /// Adds what one direction of a link, or a node, has to say.
    void add(const Evidence& evidence, Time end);
    void add(std::uint64_t more, std::optional<Time> newest, std::vector<Firing> others);
};
FaultReport report_of(const FaultSpec& spec);

}  // namespace puckloop::cosim
