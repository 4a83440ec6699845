#pragma once

namespace puckloop::chip {

/// Why translated code came back. The core's current operation is the next one.
enum class Left : int {
    NoEntry,  ///< it does not begin a block (yet)
    Slow,     ///< the interpreter executes it, then translated code may go on
    Limit,    ///< it may not be entered now: too little time for the block, mostly
};

}  // namespace puckloop::chip
