#pragma once
// What faults make of the light between range-and-bearing boards, as it is now. The medium asks for it.

#include "physics/ir/ir_coupling.h"

#include <cstddef>
#include <cstdint>

namespace puckloop::physics {

class IrFaultEffects {
  public:
    /// 1 where nothing is wrong.
    struct Factors {
        IrArray<float> emitter{}, carrier{}, level{};
    };
    virtual ~IrFaultEffects() = default;

    /// The emitters of `sender` that `receiver` sees lit, where `mask` are.
    virtual std::uint16_t lit(std::size_t sender, std::size_t receiver, std::uint16_t mask) const = 0;
    /// False: all factors are 1, `factors` was left as it is.
    virtual bool weakens(std::size_t sender, std::size_t receiver, Factors& factors) const = 0;
    /// Adds the counts of foreign light at the receivers of `board`.
    virtual void add_ambient(std::size_t board, IrArray<float>& level) const = 0;
};

}  // namespace puckloop::physics
