#pragma once
// Faults of IRcom's words on their way from a sender to a receiver: kinds ircom_kinds() of
// cosim/faults/kinds/kind_table.h.
//
// A word is known for one by its first kPreamble edges, all a MARK's half period apart; flashes of proximity
// sensors never are that many. Up to there its light arrives in any case: no receiver has begun a word with
// it, as two whole MARKs begin one. From there on a fault keeps the sender's own light from receivers (a
// block), or lights its diodes once more by another time table (a copy), or both.
// Words that reach nobody whom the fault names are no candidates.

#include "cosim/faults/fault_json.h"
#include "physics/ircom/medium.h"

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::physics {

class IrcomFaults {
  public:
    static constexpr int kPreamble = 16;  ///< edges, of the 20 of two MARKs
    /// From a word's first edge to that of the word in its place: it has ended, and receivers are at rest.
    static constexpr cosim::Time kAfterWord = 40 * cosim::kMillisecond;

    /// Throws InputError for a device that is not there.
    IrcomFaults(std::vector<cosim::CarriedFault> faults, IrcomMedium& medium);

    bool empty() const { return carried_.empty(); }
    const std::vector<cosim::CarriedFault>& carried() const { return carried_; }

    /// The lines that a device has lit have become `lines`, a bit each.
    void switched(cosim::Time now, std::size_t device, std::uint8_t lines);
    /// When a copy changes next, if nothing comes in.
    cosim::Time next() const;
    /// Copies change that are due; true if any did.
    bool apply(cosim::Time now);

    template <class Archive>
    void state(Archive& archive) {
        for (auto& fault : carried_)
            archive(fault);
        for (auto& train : trains_)
            archive(train);
        for (auto& slot : slots_)
            archive(slot);
    }

  private:
    struct Change {
        cosim::Time time = 0;
        std::uint8_t lines = 0;
    };
    /// Light of one sender since it last rested.
    struct Train {
        cosim::Time start = 0, last = 0;
        int edges = 0;
        bool word = false;
        std::uint8_t lines = 0, all = 0;  ///< lit now; lit at any time
        std::uint64_t words = 0;          ///< begun so far
        std::vector<Change> changes;      ///< up to where it is known for a word
        template <class Archive>
        void state(Archive& archive) {
            archive(start, last, edges, word, lines, all, words, changes);
        }
    };
    /// What one fault does to one sender's light.
    struct Slot {
        bool active = false;  ///< it acts on the word under way
        bool blocks = false;
        cosim::Time shift = 0;  ///< of the copy: delay, duplicate, and jitter's newest
        int position = 0;       ///< corrupt: the first half period that is lost
        std::uint64_t word = 0;
        std::vector<Change> held;             ///< swap, flip: the word, from its first edge
        cosim::Time release = cosim::kNever;  ///< flip: when it comes again
        std::uint8_t all = 0;                 ///< lines of the word that is held
        std::deque<Change> queue;             ///< of the copy
        template <class Archive>
        void state(Archive& archive) {
            archive(active, blocks, shift, position, word, held, release, all, queue);
        }
    };
    struct Where {
        std::optional<std::size_t> from, to;
    };

    std::size_t devices() const { return medium_.scene().device_count(); }
    Slot& slot(std::size_t fault, std::size_t sender) { return slots_[fault * devices() + sender]; }
    std::size_t device_of(const cosim::CarriedFault& fault, const std::string& name) const;
    bool reaches(std::size_t sender, const Where& where) const;
    void rest(std::size_t sender);
    void recognised(cosim::Time now, std::size_t sender);
    void begin(std::size_t fault, std::size_t sender, cosim::Time now);
    void follow(std::size_t fault, std::size_t sender, cosim::Time now, bool edge);
    void block(std::size_t fault, std::size_t sender, bool on);
    void play(Slot& slot, const std::vector<Change>& changes, cosim::Time shift);
    void play_word(Slot& slot, std::uint16_t symbols, bool booth, std::uint8_t lines, cosim::Time at);
    void release(std::size_t fault, std::size_t sender);
    void note(std::size_t fault, cosim::Time start, std::uint64_t word, std::string what, cosim::Time now);

    std::vector<cosim::CarriedFault> carried_;
    IrcomMedium& medium_;
    std::vector<Where> where_;   ///< as carried_
    std::vector<Train> trains_;  ///< by sender
    std::vector<Slot> slots_;    ///< [fault][sender]
};

}  // namespace puckloop::physics
