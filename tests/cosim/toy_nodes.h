#pragma once
// Small nodes for tests, made from lines like "chatter seed=3 uarts=1 signals=2".

#include "cosim/core/node.h"

#include <memory>
#include <string>

namespace puckloop::cosim::toy {

/// Kinds, and what they do:
///   chatter  acts at random times on every port, answers some of what it gets; behaves well
///   echo     answers each UART frame with the next byte after `delay_us`
///   idle     never sends anything
///   stopper  asks to end the run at `at_us`
///   thrower  throws at `at_us`        exiter  exits with status 3     aborter  raises SIGABRT
///   staller  sleeps for ever at `at_us`
///   liar     promises silence and breaks its word at `at_us`
///   turncoat promises silence, then nothing, and speaks 20 ms after `at_us`
///   mutual   promises nothing beyond its own time and answers at once: deadlocks with another one
///   refuser  cannot be made (InputError)
/// With ahead=1, chatter, echo, idle and those that act at `at_us` can go back (cosim/core/node.h),
/// with bounded=1 too only from here and there (cosim/core/bounded_rewindable.h).
std::unique_ptr<Node> make(const std::string& line);

}  // namespace puckloop::cosim::toy
