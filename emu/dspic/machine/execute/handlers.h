#pragma once
// The interpreter's handlers: an instruction's semantics in the domain of words, compiled once for every
// shape that its form can have.

#include "emu/dspic/machine/execute/words.h"

namespace puckloop::dspic {

/// Everything is inlined into it.
template <class Semantics, class Shape, class Domain = Words>
[[gnu::flatten]] const Op* execute(Machine& m, const Op* op) {
    Domain words(m);
    return Semantics::run(words, op, Shape{});
}

/// Sets of addressing modes.
constexpr unsigned modes() {
    return 0;
}
template <class... More>
constexpr unsigned modes(Ea first, More... more) {
    return 1u << static_cast<int>(first) | modes(more...);
}
inline constexpr unsigned kAnyButOffset = modes(Ea::Literal, Ea::Direct, Ea::Indirect);
inline constexpr unsigned kDirectOrIndirect = modes(Ea::Direct, Ea::Indirect);
inline constexpr unsigned kMoveModes = modes(Ea::Direct, Ea::Indirect, Ea::Offset);
/// The mode plays no part.
inline constexpr unsigned kNone = modes(Ea::Literal);

/// Calls `use` with the mode as a constant.
template <unsigned Set, class Use>
Handler with_mode(Ea mode, Use use) {
    Handler found = nullptr;
    const auto offer = [&]<Ea Mode>() {
        if constexpr ((Set >> static_cast<int>(Mode) & 1) != 0)
            if (Set == kNone || mode == Mode) found = use.template operator()<Mode>();
    };
    offer.template operator()<Ea::Literal>();
    offer.template operator()<Ea::Direct>();
    offer.template operator()<Ea::Indirect>();
    offer.template operator()<Ea::Offset>();
    return found;
}

/// The handler for an operation whose operands are bound. `Sized`: byte and word differ.
template <class Semantics, bool Sized, unsigned Sources, unsigned Destinations>
Handler pick(const Op& op) {
    return with_mode<Sources>(op.source, [&]<Ea Source>() {
        return with_mode<Destinations>(op.destination, [&]<Ea Destination>() -> Handler {
            if constexpr (Sized)
                if (op.byte) return &execute<Semantics, Fixed<true, Source, Destination>>;
            return &execute<Semantics, Fixed<false, Source, Destination>>;
        });
    });
}
template <class Semantics>
Handler pick(const Op& op) {
    return pick<Semantics, Semantics::kSized, Semantics::kSources, Semantics::kDestinations>(op);
}

// Operands that several groups of forms have.
inline void bind_base(Op& op, const Form& form, std::uint32_t word) {
    op.b = static_cast<std::uint8_t>(form.field('w', word));
}
inline void bind_source_or_literal(Op& op, const Form& form, std::uint32_t word) {
    if (form.has_field('p'))
        bind_source(op, form, word, 'p', op.byte ? 1 : 2);
    else
        op.k = static_cast<std::uint16_t>(form.field('k', word));
}
/// Wnd.
inline void bind_w(Op& op, const Form& form, std::uint32_t word) {
    op.d = static_cast<std::uint8_t>(form.field('d', word));
    sets(op, op.d);
}

}  // namespace puckloop::dspic
