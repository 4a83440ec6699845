#pragma once
// The same work for each of a number of things, on several threads. What is worked out must not depend on the
// order, so that results are the same for any number of threads.

#include <cstddef>
#include <functional>

namespace puckloop::gap {

/// Calls `work` for 0 .. count - 1; returns when all are done. The first exception (by number) is thrown on.
void in_parallel(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work);

}  // namespace puckloop::gap
