#pragma once
// The symbolic walk through one iteration of a loop: see loop_plan.h. Instructions have the interpreter's
// semantics (machine/execute/semantics.h) over the domain of affine values.

#include "emu/dspic/walk/affine_domain.h"

namespace puckloop::dspic {

class SymbolicLoop : private AffineDomain {
  public:
    using AffineDomain::Probe;
    using AffineDomain::Verdict;

    SymbolicLoop(const Machine& m, LoopPlan& plan, LoopTrace& trace, const Probe& probe = {})
        : AffineDomain(m, plan, trace, probe) {}
    /// Walks from `head` until `branch` is taken again, twice: to find the steps, then to prove them.
    Verdict analyse(const Op* branch, const Op* head);
    /// One walk from `head` until `branch` is taken again; false if it does not come round.
    bool comes_round(const Op* branch, const Op* head);
    /// The walk came by a conditional branch or skip.
    bool chose() const { return chose_; }

  private:
    void walk(const Op* branch, const Op* head);
    const Op* execute(const Op* op);
    void hazards(const Op* op);
    void record(const Op* op);
    void settle();

    std::uint32_t watch_ = 0;  ///< Op::writes of the instruction before
};

}  // namespace puckloop::dspic
