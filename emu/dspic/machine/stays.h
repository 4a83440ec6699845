#pragma once
// What the machine keeps of its program's waiting: the loop that it has been going round in, at each CPU
// level, and since when. Filled by waits/wait_watch.h, and by translated code.

#include "emu/dspic/machine/event_queue.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace puckloop::dspic {

struct Op;

/// A word whose value decides whether a loop goes on: register below 0x0800, else RAM.
struct LoopCondition {
    std::uint16_t address = 0;
    std::uint16_t mask = 0;  ///< bits that matter
    bool exact = true;       ///< false: bits that may matter, no single one was found

    template <class Archive>
    void state(Archive& archive) {
        archive(address, mask, exact);
    }
};

/// What was found out about a loop while the program was in it.
struct LoopFinding {
    std::uint32_t first = 0, last = 0;      ///< its head and its branch, program addresses
    std::vector<LoopCondition> conditions;  ///< none: nothing that the loop reads makes it end
    bool ends = false;                      ///< it counts something that ends it

    template <class Archive>
    void state(Archive& archive) {
        archive(first, last, conditions, ends);
    }
};

/// A loop that waited, at least once, for bits that silicon changes and no model does.
struct MissingPoll {
    Cycle cycle = 0;
    std::uint32_t first = 0, last = 0;
    LoopCondition condition;

    template <class Archive>
    void state(Archive& archive) {
        archive(cycle, first, last, condition);
    }
};

struct WaitWatch {
    struct Stay {
        const Op* branch = nullptr;  ///< null: none
        const Op* head = nullptr;
        std::uint16_t stack = 0;  ///< W15 at the branch
        Cycle since = 0, last = 0;
        Cycle next_look = 0;
        std::optional<LoopFinding> finding;
    };
    std::array<Stay, 16> stays;  ///< by CPU level
    int level = 0;               ///< of the last arrival
    std::vector<MissingPoll> polls;
    Cycle stale_after = 0;  ///< cycles without an arrival that end a stay; by note_rate()

    void forget() {
        stays = {};
        level = 0;
    }
};

/// A loop within the one that is stayed in, or in what it calls, is part of it. `stack`: W15 at the branch.
inline bool is_inside(const WaitWatch::Stay& stay, const Op* branch, std::uint16_t stack) {
    return (branch >= stay.head && branch <= stay.branch) || stack > stay.stack;
}

}  // namespace puckloop::dspic
