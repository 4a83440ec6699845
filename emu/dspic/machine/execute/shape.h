#pragma once
// What of an instruction is fixed when its word is decoded: byte or word, and how its operands are reached.

#include "emu/dspic/machine/machine.h"

namespace puckloop::dspic {

/// Known when the interpreter is compiled: one handler per shape.
template <bool Byte, Ea Source, Ea Destination>
struct Fixed {
    static constexpr bool byte = Byte;
    static constexpr Ea source = Source;
    static constexpr Ea destination = Destination;
};

/// Read from the decoded operation: for the walks, which execute an instruction once.
struct Decoded {
    bool byte;
    Ea source;
    Ea destination;
    explicit Decoded(const Op& op) : byte(op.byte), source(op.source), destination(op.destination) {}
};

/// The same shape for a byte operand (SE, ZE).
template <class Shape>
struct AsByte : Shape {
    static constexpr bool byte = true;
    explicit AsByte(Shape shape) : Shape(shape) {}
};

/// All bits of a byte or a word.
constexpr std::uint32_t ones(bool byte) {
    return byte ? 0xFF : 0xFFFF;
}
/// The sign bit of a byte or a word.
constexpr std::uint32_t top(bool byte) {
    return byte ? 0x80 : 0x8000;
}

}  // namespace puckloop::dspic
