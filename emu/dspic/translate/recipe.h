#pragma once
// What one instruction does, as its semantics (machine/execute) lay it out: which memory it reaches, what
// values it makes of that and of registers, where these go and which flags come of them. The semantics are
// executed once, when a block is translated, in a domain that notes this down (machine/execute/words.h
// defines what a domain is); code is made of the notes then (recipe_code.cpp).

#include "emu/dspic/machine/machine.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace puckloop::dspic::translate {

struct Recipe {
    /// A number known when translating, or the outcome of a node.
    struct Value {
        bool known = false;
        std::uint16_t number = 0;  ///< or the node's
        bool operator==(const Value&) const = default;
    };
    static Value number(std::uint32_t n) { return {true, static_cast<std::uint16_t>(n)}; }

    /// True or false when the code runs.
    struct Bit {
        enum class From : std::uint8_t {
            Known,
            Carry,   ///< C as it was
            Masked,  ///< any bit of `a` in `mask`
            Equal,   ///< a == b
            Less,    ///< a < b, signed
        };
        From from = From::Known;
        bool inverted = false;  ///< Known: the bit itself
        bool byte = false;      ///< of Equal and Less
        Value a, b;
        std::uint16_t mask = 0;

        Bit() = default;
        Bit(bool known) : inverted(known) {}
        bool is(bool known) const { return from == From::Known && inverted == known; }
        Bit operator!() const {
            Bit opposite = *this;
            opposite.inverted = !inverted;
            return opposite;
        }
        Bit operator==(bool wanted) const { return wanted ? *this : !*this; }
    };

    struct Node {
        enum class Kind : std::uint8_t {
            Register,  ///< W, as the instruction finds it
            Cell,      ///< memory, as the instruction finds it
            Plus,      ///< a + b in 16 bits
            And,
            Ior,
            Xor,
            Left,          ///< a << b in 16 bits
            Right,         ///< a >> b
            SignedRight,   ///< the same of a signed word, in 16 bits
            Doubled,       ///< a << 1, with `in` in bit 0
            Halved,        ///< a >> 1, with `in` in the highest bit
            SignExtended,  ///< a byte to a word
            Swapped,       ///< halves of a word, or of a byte
            Sum,           ///< the adder's
            LowProduct,
            HighProduct,
        };
        Kind kind{};
        bool byte = false;                        ///< the outcome has eight bits
        std::uint8_t place = 0;                   ///< Register: its number; Cell: the access
        bool second = false;                      ///< Cell: the next word after the address
        bool signed_a = false, signed_b = false;  ///< of products
        Value a{}, b{};
        Bit in{};
    };

    /// An address that is reached: `base` + `offset`.
    struct Access {
        Value base;  ///< known: a literal address, `offset` 0
        int offset = 0;
        bool byte = false;
        bool stack = false;  ///< within the stack's limits
        bool reads = false, writes = false;
        bool two = false;  ///< that word and the next one
    };

    /// Registers and memory that it changes, in order.
    struct Effect {
        bool to_memory = false;
        std::uint8_t place = 0;  ///< the register, or the access
        bool second = false;     ///< the next word after the address
        bool byte = false;
        Value value;
    };

    /// a + b + carry through the adder, which sets all flags.
    struct Sum {
        bool byte = false;
        bool sticky = false;  ///< Z is only ever cleared
        Value a, b;
        Bit carry;
        Value outcome;
    };

    std::vector<Node> nodes;
    std::vector<Access> accesses;
    std::vector<Effect> effects;
    std::optional<Sum> sum;
    std::optional<Value> result;  ///< N and Z come of it
    bool result_byte = false;
    std::optional<Bit> c, z;  ///< set alone, or beside `result`
    std::optional<Bit> skips;

    const Node& node(Value value) const { return nodes[value.number]; }
    bool is(Value value, Node::Kind kind) const { return !value.known && node(value).kind == kind; }
};

/// What the operation does; nothing if its form is not written over domains, or does what no recipe can say.
std::optional<Recipe> recipe_of(const Machine& m, const Op* op);

}  // namespace puckloop::dspic::translate
