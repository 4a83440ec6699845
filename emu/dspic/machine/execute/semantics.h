#pragma once
// Every instruction that is written over a domain (words.h), by its form.

#include "emu/dspic/machine/execute/arithmetic.h"
#include "emu/dspic/machine/execute/bits.h"
#include "emu/dspic/machine/execute/branches.h"
#include "emu/dspic/machine/execute/moves.h"
#include "emu/dspic/machine/execute/products.h"
#include "emu/dspic/machine/execute/shifts.h"

namespace puckloop::dspic {

/// Executes an operation once in a domain. Null if its form is written for the interpreter alone.
template <class D>
const Op* execute_in(D& domain, const Op* op) {
    const Op* next = nullptr;
    const auto run = [&](auto semantics) { next = semantics.run(domain, op, Decoded(*op)); };
    with_move(op->form, run) || with_arithmetic(op->form, run) || with_bits(op->form, run) ||
        with_branch(op->form, run) || with_shift(op->form, run) || with_product(op->form, run);
    return next;
}

}  // namespace puckloop::dspic
