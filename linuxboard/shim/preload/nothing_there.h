#pragma once
// The last answer of the node that said "nothing there". It holds until the time up to which the node said
// that nothing can happen, or until the next request: a polling loop asks the node only once a grant.

#include "linuxboard/shim/preload/link.h"

#include <cstddef>
#include <cstdint>

namespace puckloop::shim {

struct NothingThere {
    wire::Request request;
    std::uint64_t data_hash = 0;
    std::uint64_t transaction = 0;  ///< number of the request that was answered so
    std::int64_t result = 0;
    int error = 0;
};

std::uint64_t hash_of(const void* data, std::size_t size);
/// The request only looks: a read or poll that does not wait, a question for what is there.
bool is_look(const wire::Request& request, std::int64_t now);
/// The answer to the same look, if `transaction` is still the last request; else nullptr.
const NothingThere* still_nothing(const wire::Request& request, const void* data, std::size_t size,
                                  std::uint64_t transaction);
void remember_nothing(const NothingThere& answer);

}  // namespace puckloop::shim
