#pragma once
// A packet on its way through a network.

#include "cosim/core/message.h"

#include <cstddef>
#include <cstdint>

namespace puckloop::network {

/// A packet on its way to one computer.
struct Passage {
    std::uint64_t number = 0;  ///< of the packet in the run, from 0
    std::size_t from = 0, to = 0;
    cosim::Time start = 0;     ///< its transmission begins
    cosim::Time duration = 0;  ///< of that
    cosim::Time arrival = 0;   ///< if nothing happens to it
    cosim::Octets octets{};
    bool many = false;  ///< it is for several computers
};

}  // namespace puckloop::network
