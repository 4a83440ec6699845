#pragma once
// Faults of the light between range-and-bearing boards, each on the link "<robot>.ir" of a robot: what its
// board sends (`from` its board), what comes to it (`from` the medium), or both.
//
//   weak_emitter `emitter` `gain`; weak_receiver `receiver` `gain`     frame by frame
//   occlusion `other` `bearing` `width` `gain`                            frame by frame and pair of boards
//   chip_flip `chip`                                                   chip by chip
//   chip_jitter `jitter`                                               edge by edge
//   ambient_burst `receiver` `level` `gain`                            during the window
//
// A frame suffers from its first light to the next frame's. Chips are counted from 0, the first light; they
// follow the sender's edges, and between them its nominal chip.

#include "cosim/faults/fault_json.h"
#include "physics/ir/ir_fault_effects.h"
#include "physics/ir/ir_medium.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::physics {

class IrFaults final : public IrFaultEffects {
  public:
    /// Throws InputError: a link or a robot that is not there. `medium` stays.
    IrFaults(std::vector<cosim::CarriedFault> faults, const IrMedium& medium);

    /// When something happens next without a message.
    cosim::Time next() const { return next_; }
    /// Does what is due at `now`. What it changes is in again() and shone().
    void act(cosim::Time now);
    /// The emitters of `sender` are these now, and the medium knows; `begins`: with them a frame begins.
    void emits(cosim::Time now, std::size_t sender, std::uint16_t mask, bool begins);

    /// Has the light of `sender` to be computed anew? Cleared by it.
    bool again(std::size_t sender);
    /// Has foreign light on `board` changed? Cleared by it.
    bool shone(std::size_t board);

    // IrFaultEffects
    std::uint16_t lit(std::size_t sender, std::size_t receiver, std::uint16_t mask) const override;
    bool weakens(std::size_t sender, std::size_t receiver, Factors& factors) const override;
    void add_ambient(std::size_t board, IrArray<float>& level) const override;

    const std::vector<cosim::CarriedFault>& faults() const { return faults_; }

    /// Between two advances nothing is to be done again.
    template <class Archive>
    void state(Archive& archive) {
        archive.fixed(faults_);
        archive(frames_, hits_, heard_, tracks_, seen_, late_, on_, next_);
    }

  private:
    enum class Kind : std::uint8_t { Emitter, Receiver, Occlusion, Ambient, Flip, Jitter };
    /// What a fault's parameters mean.
    struct Plan {
        Kind kind = Kind::Emitter;
        std::size_t board = 0;
        bool sent = true, arriving = true;
        std::uint16_t parts = 0;  ///< emitters or receivers, bit 0 is the first
        float gain = 1.0F, level = 0.0F;
        std::int64_t chip = -1;  ///< -1: any
        double jitter = 0.0;     ///< s
        std::size_t other = kAnybody;
        bool sector = false;
        double bearing = 0.0, width = 0.0;  ///< rad
    };
    /// The chips of a sender's frame.
    struct Track {
        bool lit = false;
        cosim::Time edge = 0;                 ///< the newest
        std::int64_t chip = -1, at_edge = 0;  ///< under way, and the one that began with the edge
        cosim::Time next = cosim::kNever;     ///< the next one's begin, if no edge comes before
        std::uint16_t mask = 0;               ///< emitters that a dark chip would have
    };
    /// What a receiver sees of a sender.
    struct Seen {
        std::uint16_t mask = 0;
        std::uint16_t late = 0;  ///< edges on the way
        bool flipped = false;
    };
    struct Late {
        cosim::Time time = 0;
        std::uint32_t sender = 0, receiver = 0;
        std::uint16_t mask = 0;
    };
    static constexpr std::size_t kAnybody = ~std::size_t{0};

    Plan plan_of(const cosim::FaultSpec& spec) const;
    std::size_t board_named(const cosim::FaultSpec& spec, std::string_view name) const;
    bool concerns(const Plan& plan, std::size_t sender, std::size_t receiver) const;
    bool shades(const Plan& plan, std::size_t sender, std::size_t receiver) const;
    void begin_frame(cosim::Time now, std::size_t sender);
    void hit(std::size_t fault, cosim::Time now, std::size_t sender, std::size_t receiver);
    void follow(cosim::Time now, std::size_t sender, std::uint16_t mask, bool begins);
    void spread(cosim::Time now, std::size_t sender, std::uint16_t mask);
    void begin_chip(cosim::Time now, std::size_t sender);
    void flip(cosim::Time now, std::size_t fault, std::size_t sender);
    void settle_next(cosim::Time now);
    std::string pair(std::size_t sender, std::size_t receiver) const;

    std::size_t path(std::size_t sender, std::size_t receiver) const { return sender * boards_ + receiver; }
    bool was_hit(std::size_t fault, std::size_t sender, std::size_t receiver) const {
        return hits_[path(sender, receiver) * faults_.size() + fault] != 0;
    }

    std::vector<cosim::CarriedFault> faults_;
    const IrMedium& medium_;
    std::size_t boards_;
    std::vector<Plan> plans_;
    std::vector<cosim::Time> chip_;  // by sender
    std::vector<bool> flips_;        // senders of which a chip may be inverted
    bool chips_ = false;             // some fault is about chips
    std::vector<std::uint64_t> frames_;
    std::vector<std::uint8_t> hits_;   // [sender][receiver][fault]: the present frame suffers
    std::vector<std::uint8_t> heard_;  // [sender][receiver]: it would arrive
    std::vector<Track> tracks_;
    std::vector<Seen> seen_;        // [sender][receiver]
    std::vector<Late> late_;        // by time
    std::vector<std::uint8_t> on_;  // ambient bursts
    cosim::Time next_ = cosim::kNever;
    std::vector<std::uint8_t> again_, shone_;
};

}  // namespace puckloop::physics
