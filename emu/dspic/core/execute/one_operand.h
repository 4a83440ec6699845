#pragma once
// Instructions of one operand (INC, NEG, COM, the shifts by one bit, ...): handlers for each way to reach
// source and destination, and their binding. An Operation has `template <bool Byte> static apply(Machine&,
// operand)`.

#include "emu/dspic/core/machine.h"

#include <type_traits>

namespace puckloop::dspic {

template <class Operation, bool Byte, Ea Source, Ea Destination>
const Op* one_operand(Machine& m, const Op* op) {
    const std::uint32_t s = source<Byte, Source>(m, op);
    destination<Byte, Destination>(m, op, Operation::template apply<Byte>(m, s));
    return op + 1;
}

template <class Operation, bool Byte, bool ToFile>
const Op* one_file(Machine& m, const Op* op) {
    const std::uint32_t result = Operation::template apply<Byte>(m, read_data<Byte>(m, op->k));
    if constexpr (ToFile)
        write_data<Byte>(m, op->k, static_cast<std::uint16_t>(result));
    else
        put_w<Byte>(m, 0, result);
    return op + 1;
}

/// Forms "f", "f,WREG" and "Ws,Wd".
template <class Operation>
bool bind_one_operand(Op& op, const Form& form, std::uint32_t word) {
    const bool byte = form.field('B', word) != 0;
    if (form.has_field('f')) {
        op.k = static_cast<std::uint16_t>(form.field('f', word));
        if (form.operands.ends_with("WREG")) {
            sets(op, 0);
            op.base = byte ? &one_file<Operation, true, false> : &one_file<Operation, false, false>;
        } else {
            op.base = byte ? &one_file<Operation, true, true> : &one_file<Operation, false, true>;
        }
        return true;
    }
    const Ea from = bind_source(op, form, word, 'p', byte ? 1 : 2);
    const Ea to = bind_destination(op, form, word, 'q', byte ? 1 : 2);
    const auto pick = [&](auto byte_tag) -> Handler {
        constexpr bool kByte = decltype(byte_tag)::value;
        if (from == Ea::Direct)
            return to == Ea::Direct ? &one_operand<Operation, kByte, Ea::Direct, Ea::Direct>
                                    : &one_operand<Operation, kByte, Ea::Direct, Ea::Indirect>;
        return to == Ea::Direct ? &one_operand<Operation, kByte, Ea::Indirect, Ea::Direct>
                                : &one_operand<Operation, kByte, Ea::Indirect, Ea::Indirect>;
    };
    op.base = byte ? pick(std::true_type{}) : pick(std::false_type{});
    return true;
}

}  // namespace puckloop::dspic
