#pragma once
// What becomes known of loops and service routines while a mark is set (Core::mark()), and what is forgotten:
// noted at its first change, taken back at a rewind. A machine that went back so skips where one would that
// never ran ahead; skips differ from executing in nothing but dead words above the stack and arrivals noted.

#include "emu/dspic/fast/idle_loops.h"
#include "emu/dspic/fast/isr_summary.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace puckloop::dspic {

struct Machine;

class LoopUndo {
  public:
    bool on() const { return on_; }
    /// Notes from here on; forgets earlier notes.
    void begin(const Machine& m);
    void end();
    /// Takes back everything noted; notes go on.
    void rewind(Machine& m);

    /// Before anything known of a branch changes.
    void note(IdleLoops::Branch& branch) {
        if (on_ && branch.noted != stamp_) note_first(branch);
    }
    /// Before a noted branch is walked anew.
    void note_walk(IdleLoops::Branch& branch);
    /// Before what is known of an interrupt vector changes.
    void note_isr_summary(std::size_t vector, const std::optional<IsrSummary>& before) {
        if (on_ && !forgotten_) summaries_.emplace_back(vector, before);
    }
    /// Before all of it is thrown away.
    void note_forgetting(Machine& m);

  private:
    struct Note {
        IdleLoops::Branch* branch = nullptr;
        std::uint8_t patience = 0;
        bool polls_noted = false;
        bool walked = false;
        bool swapped = false;  ///< `trace` holds the old one whole, else no more than its numbers
        IdleLoops::Plan plan;
        LoopTrace trace;
    };
    /// Everything that was known when it was first thrown away.
    struct Forgotten {
        std::vector<std::uint16_t> index;
        std::deque<IdleLoops::Branch> branches;
        std::vector<std::uint16_t> waits;
        std::vector<std::optional<IsrSummary>> isr_summaries;
    };
    void note_first(IdleLoops::Branch& branch);
    void take_back(Machine& m);

    bool on_ = false;
    std::uint32_t stamp_ = 0;
    std::deque<Note> notes_;  ///< the first count_ are in use
    std::size_t count_ = 0;
    std::vector<std::uint16_t> waits_;  ///< as they were at the mark
    std::vector<std::pair<std::size_t, std::optional<IsrSummary>>> summaries_;
    std::optional<Forgotten> forgotten_;
};

}  // namespace puckloop::dspic
