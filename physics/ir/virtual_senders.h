#pragma once
// Boards that are not there: when their light goes on and off. Frames of docs/rab.md's form, at times drawn
// from one stream a board.

#include "base/random.h"
#include "cosim/core/time.h"
#include "physics/description/description.h"

#include <cstddef>
#include <vector>

namespace puckloop::physics {

class VirtualSenders {
  public:
    /// `chip`: time of half a bit.
    VirtualSenders(const World& world, cosim::Time chip);

    /// The next time at which light changes; kNever without boards.
    cosim::Time next() const;
    /// Calls shine(number, lit) for each board whose light changes at `now`, which next() gave.
    template <class Shine>
    void act(cosim::Time now, Shine shine) {
        for (std::size_t i = 0; i < senders_.size(); ++i) {
            if (senders_[i].next > now) continue;
            shine(i, senders_[i].lit = !senders_[i].lit);
            go_on(senders_[i]);
        }
    }

    template <class Archive>
    void state(Archive& archive) {
        for (Sender& sender : senders_)
            archive(sender.turn, sender.edge, sender.begin, sender.next, sender.lit, sender.jitter);
    }

  private:
    struct Sender {
        std::vector<cosim::Time> edges;  // of a frame, from its begin; on, off, on, ...
        cosim::Time every = 0, first = 0;
        double deviation = 0.0;  // s
        std::uint64_t turn = 0;  // frames begun
        std::size_t edge = 0;
        cosim::Time begin = 0, next = 0;
        bool lit = false;
        RandomStream jitter;
    };
    static void plan(Sender& sender);
    static void go_on(Sender& sender);

    std::vector<Sender> senders_;
};

}  // namespace puckloop::physics
