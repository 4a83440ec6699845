// How the medium goes back to a mark: rows of paths, bodies and shapes are copied before their first change.

#include "physics/ir/ir_medium.h"

namespace puckloop::physics {

namespace {

/// The next note in use; its containers keep their room from one mark to the next.
template <class Note>
Note& next(std::vector<Note>& notes, std::size_t& count) {
    if (count == notes.size()) notes.emplace_back();
    return notes[count++];
}

}  // namespace

void IrMedium::mark() {
    undo_.on = true;
    undo_.rows_noted.assign(boards_.size(), 0);
    undo_.bodies_noted.assign(moving_.size(), false);
    undo_.bodies.clear();
    undo_.light_count = undo_.row_count = 0;
    undo_.shapes.reset();
    undo_.mirrors = false;
}

/// Emitters change many times in a burst, the coupling does not: then the light is all there is to copy.
void IrMedium::note_light(std::size_t sender) {
    if (!undo_.on || undo_.rows_noted[sender] != 0) return;
    undo_.rows_noted[sender] = Undo::kLight;
    auto& note = next(undo_.lights, undo_.light_count);
    note.sender = sender;
    note.light.clear();
    for (std::size_t r = 0; r < boards_.size(); ++r)
        note.light.push_back(path(sender, r).light);
}

void IrMedium::note_row(std::size_t sender) {
    if (!undo_.on || (undo_.rows_noted[sender] & Undo::kRow) != 0) return;
    undo_.rows_noted[sender] |= Undo::kRow;
    auto& note = next(undo_.rows, undo_.row_count);
    note.sender = sender;
    note.paths.clear();
    note.spells.clear();
    for (std::size_t r = 0; r < boards_.size(); ++r) {
        note.paths.push_back(path(sender, r));
        note.spells.push_back(spell(sender, r));
    }
}

void IrMedium::note_body(std::size_t index) {
    if (!undo_.on || undo_.bodies_noted[index]) return;
    undo_.bodies_noted[index] = true;
    auto& note = undo_.bodies.emplace_back();
    note.index = index;
    note.shape = moving_[index];
    if (board_of_[index] < boards_.size()) note.model = boards_[board_of_[index]].model;
}

void IrMedium::note_shapes() {
    undo_.mirrors = true;
    if (!undo_.on || undo_.shapes) return;
    undo_.shapes = Undo::Shapes{fixed_, added_};
}

void IrMedium::rewind() {
    // In the reverse of the order in which they can have been noted. Two boards share a spell.
    for (std::size_t i = undo_.row_count; i-- > 0;) {
        const Undo::Row& row = undo_.rows[i];
        for (std::size_t r = 0; r < boards_.size(); ++r) {
            path(row.sender, r) = row.paths[r];
            spell(row.sender, r) = row.spells[r];
        }
    }
    for (std::size_t i = 0; i < undo_.light_count; ++i)
        for (std::size_t r = 0; r < boards_.size(); ++r)
            path(undo_.lights[i].sender, r).light = undo_.lights[i].light[r];
    for (const Undo::Body& body : undo_.bodies) {
        moving_[body.index] = body.shape;
        if (body.model) boards_[board_of_[body.index]].model = *body.model;
    }
    if (undo_.shapes) {
        fixed_ = undo_.shapes->fixed;
        added_ = undo_.shapes->added;
    }
    if (undo_.mirrors) find_mirrors();
    mark();
}

}  // namespace puckloop::physics
