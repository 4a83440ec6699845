#pragma once
// Interrupt service routines remembered by what they read, one path at a time.
//
// Most interrupts find the routine doing what it did before: the same branches, other numbers. A walk through
// the routine from the machine's present state (path_domain.h) yields one path: within which bounds the words
// that it read must lie for the same instructions to follow, how long they take, and what every word that
// they write becomes, as a constant or as a word that was read plus a constant. When the interrupt comes
// again, the words are compared, and the path is taken in one step; else the routine is executed. Only what
// touches the core's registers, RAM and registers that are plain storage can be remembered.
// (epuck_firmware.hex copies the converter's results in an interrupt 12,000 times a second, byte by byte.)

#include "emu/dspic/machine/event_queue.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace puckloop::dspic {

struct Machine;
struct Op;

struct IsrPath {
    /// The word lies within [low, low + span].
    struct Guard {
        const std::uint16_t* word = nullptr;
        std::uint16_t low = 0, span = 0;
        bool holds() const { return static_cast<std::uint16_t>(*word - low) <= span; }
    };
    /// A word that was read plus a constant, or, with the word kNothing, the constant alone.
    struct Term {
        static constexpr std::uint16_t kNothing = 0;
        const std::uint16_t* word = &kNothing;
        std::uint16_t constant = 0;
        std::uint16_t value() const { return static_cast<std::uint16_t>(*word + constant); }
        bool reads() const { return word != &kNothing; }
    };
    struct Store {
        std::uint16_t* to = nullptr;
        Term term;
    };
    /// Above the interrupted stack pointer; the exception frame is not among them.
    struct Push {
        std::uint16_t place = 0;  ///< in words from there
        Term term;
    };
    /// The adder's last operands, which leave DC.
    struct Sum {
        bool done = false;
        bool byte = false;
        bool carry = false;
        Term a, b;
    };

    /// Taken backward branches (waits/), the first and the last one of the same branch in a row.
    struct Arrival {
        const Op* branch = nullptr;
        const Op* head = nullptr;
        std::uint16_t depth = 0;    ///< of W15 above the interrupted program's
        Cycle first = 0, last = 0;  ///< starts of the branch, from the routine's
    };

    std::vector<Guard> guards;
    std::vector<Arrival> arrivals;
    std::vector<Push> pushes;
    std::vector<Store> stores;  ///< in this order ...
    bool at_once = false;       ///< ... unless one writes what another reads
    Sum sum;
    std::uint16_t depth = 0;                     ///< bytes of stack in use at most
    std::uint16_t lowest = 0xFFFF, highest = 0;  ///< RAM addresses that are not relative to the stack
    bool converts = false;                       ///< reads the converter's results ...
    Cycle last_conversion = 0;  ///< ... in an instruction that starts so many cycles after the routine
    std::uint32_t uses = 0, keep = 0, writes = 0;  ///< as IsrSummary's
    Cycle cycles = 0;
    Cycle returns = 0;  ///< start of RETFIE, from the routine's
    std::uint64_t instructions = 0;
    std::size_t next = 0;  ///< the path that was taken the next time
};

/// What is known of one interrupt's routine.
struct IsrPaths {
    std::uint32_t handler = 0;  ///< program address
    std::uint32_t layout = 0;   ///< SfrSpace::layout_changes()
    std::vector<IsrPath> paths;
    std::size_t recent = 0;
    std::uint32_t credit = 0;    ///< walks that are still free
    std::uint32_t pause = 0;     ///< services until the next walk
    std::uint32_t rest = 0;      ///< services until paths are looked at again
    std::uint32_t hits = 0;      ///< since the last walk that was not free
    std::uint32_t misses = 0;    ///< less some for every hit
    std::uint32_t failures = 0;  ///< such walks in a row that did not pay
};

/// A routine about to begin.
struct Service {
    Cycle start = 0;
    int level = 0;  ///< of the CPU
};
/// Some path of the routine of this interrupt is known.
bool has_paths(const Machine& m, int vector);
/// The path that the routine of this interrupt takes; null: it is to be executed.
const IsrPath* isr_path(Machine& m, int vector, const Service& service);
/// Does what the path leaves behind in registers, RAM and SR, and notes its arrivals. The program interrupted
/// is at Machine::current.
void take_path(Machine& m, const IsrPath& path, const Service& service);

}  // namespace puckloop::dspic
