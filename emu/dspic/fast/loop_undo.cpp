#include "emu/dspic/fast/loop_undo.h"

#include "emu/dspic/fast/known_services.h"
#include "emu/dspic/machine/machine.h"

#include <utility>

namespace puckloop::dspic {

void LoopUndo::begin(const Machine& m) {
    end();
    on_ = true;
    ++stamp_;
    waits_ = m.skip->waits;  // small, and translated code counts them down
}

void LoopUndo::end() {
    on_ = false;
    count_ = 0;
    summaries_.clear();
    forgotten_.reset();
}

void LoopUndo::note_first(IdleLoops::Branch& branch) {
    branch.noted = stamp_;
    if (forgotten_) return;  // learned after everything was thrown away: it will be thrown away itself
    branch.note = count_;
    if (count_ == notes_.size()) notes_.emplace_back();
    Note& note = notes_[count_++];
    note.branch = &branch;
    note.patience = branch.patience;
    note.polls_noted = branch.polls_noted;
    note.walked = branch.walked;
    note.plan = branch.plan;
    note.swapped = false;
    note.trace.iterations = branch.trace.iterations;
    note.trace.steady = branch.trace.steady;
    note.trace.depth = branch.trace.depth;
    note.trace.live = branch.trace.live;
}

void LoopUndo::note_walk(IdleLoops::Branch& branch) {
    if (!on_ || forgotten_) return;
    Note& note = notes_[branch.note];
    if (std::exchange(note.swapped, true)) return;
    note.trace.boundaries.swap(branch.trace.boundaries);
    note.trace.accesses.swap(branch.trace.accesses);
}

void LoopUndo::take_back(Machine& m) {
    for (std::size_t i = 0; i < count_; ++i) {
        Note& note = notes_[i];
        IdleLoops::Branch& branch = *note.branch;
        branch.patience = note.patience;
        branch.polls_noted = note.polls_noted;
        branch.walked = note.walked;
        branch.plan = note.plan;
        branch.trace.iterations = note.trace.iterations;
        branch.trace.steady = note.trace.steady;
        branch.trace.depth = note.trace.depth;
        branch.trace.live = note.trace.live;
        if (!note.swapped) continue;
        branch.trace.boundaries.swap(note.trace.boundaries);
        branch.trace.accesses.swap(note.trace.accesses);
        branch.table.trace = nullptr;
    }
    count_ = 0;
    m.skip->waits = waits_;
    m.skip->waits.resize(m.skip->branches.size(), 0);
    publish_loops(m);
    for (auto note = summaries_.rbegin(); note != summaries_.rend(); ++note)
        m.services->summaries[note->first] = note->second;
    summaries_.clear();
}

void LoopUndo::note_forgetting(Machine& m) {
    if (!on_ || forgotten_) return;
    take_back(m);
    forgotten_.emplace(Forgotten{std::move(m.skip->index), std::move(m.skip->branches),
                                 std::move(m.skip->waits), std::move(m.services->summaries)});
}

void LoopUndo::rewind(Machine& m) {
    m.skip->position = {};
    if (forgotten_) {
        m.services->paths.clear();  // of code that is not there any more
        m.skip->index = std::move(forgotten_->index);
        m.skip->branches = std::move(forgotten_->branches);
        m.skip->waits = std::move(forgotten_->waits);
        publish_loops(m);
        m.services->summaries = std::move(forgotten_->isr_summaries);
    } else {
        take_back(m);
    }
    begin(m);
}

}  // namespace puckloop::dspic
