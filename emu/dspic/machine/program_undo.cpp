#include "emu/dspic/machine/program_undo.h"

#include "emu/dspic/machine/machine.h"

namespace puckloop::dspic {

void ProgramUndo::note_operation(const Machine& m, std::uint32_t index) {
    const Op& op = m.code[index];
    operations_.push_back({index, op.marks, op.run != &decode_now, op.may_skip});
}

void ProgramUndo::rewind(Machine& m) {
    on_ = false;  // what follows is no change to note
    for (auto word = words_.rbegin(); word != words_.rend(); ++word)
        store_program(m, word->address, word->word);
    for (auto note = operations_.rbegin(); note != operations_.rend(); ++note) {
        Op& op = m.code[note->index];
        op.marks = note->marks;
        blank(m, note->index);
        if (!note->decoded) continue;
        decode(m, op);
        op.may_skip = note->may_skip;
    }
    begin();
}

}  // namespace puckloop::dspic
