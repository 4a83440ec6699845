#pragma once
// What runs that had no part in a cause's choice or fit say of it.

#include <cstddef>
#include <string>

namespace puckloop::gap {

/// Choice and fit on one half of the runs, score on the other: the only runs that had no part in either.
struct Confirmation {
    std::size_t runs = 0, scored = 0;  ///< of the half that chose, and of the other; 0: not asked
    bool chosen = false;               ///< the first cause of all runs is among what the half chose by itself
    double gain = 0.0;                 ///< nats on the other half, of what the half chose, fitted there
    std::string sentence;
};

}  // namespace puckloop::gap
