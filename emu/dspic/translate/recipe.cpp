#include "emu/dspic/translate/recipe.h"
#include "emu/dspic/machine/execute/semantics.h"
#include "emu/dspic/walk/symbolic_execution.h"

namespace puckloop::dspic::translate {

namespace {

/// Thrown: no recipe can say it.
struct Stop {};

/// The domain in which an instruction's semantics note down what they do.
class RecipeDomain : public SymbolicExecution<RecipeDomain> {
    friend SymbolicExecution<RecipeDomain>;
    using Kind = Recipe::Node::Kind;

  public:
    using Value = Recipe::Value;
    using Bit = Recipe::Bit;
    struct Address {
        Value base;
        int offset = 0;
        bool stack = false;
    };
    struct Product {
        Value low, high;
    };

    RecipeDomain(const Machine& m, Recipe& recipe) : m_(m), recipe_(recipe) {}

    static Value value(std::uint32_t number) { return Recipe::number(number); }
    static std::uint32_t word(Value value) {
        if (!value.known) throw Stop{};
        return value.number;
    }
    static Address address(std::uint16_t number) { return {value(number)}; }

    // Operations on values.
    Value complement(bool byte, Value a) { return exclusive(a, value(ones(byte))); }
    Value conjunction(Value a, Value b) { return combined(Kind::And, a, b); }
    Value disjunction(Value a, Value b) { return combined(Kind::Ior, a, b); }
    Value exclusive(Value a, Value b) { return combined(Kind::Xor, a, b); }
    Value left(Value a, Value count) { return node({.kind = Kind::Left, .a = a, .b = count}); }
    Value right(Value a, Value count) { return node({.kind = Kind::Right, .a = a, .b = count}); }
    Value signed_right(Value a, Value count) { return node({.kind = Kind::SignedRight, .a = a, .b = count}); }
    Value doubled(bool byte, Value a, Bit in) {
        return node({.kind = Kind::Doubled, .byte = byte, .a = a, .in = in});
    }
    Value halved(bool byte, Value a, Bit in) {
        return node({.kind = Kind::Halved, .byte = byte, .a = a, .in = in});
    }
    Value sign_extended(Value a) { return node({.kind = Kind::SignExtended, .a = a}); }
    Value swapped(bool byte, Value a) { return node({.kind = Kind::Swapped, .byte = byte, .a = a}); }
    Value with_bit(Value, Value, Bit) { throw Stop{}; }
    Product product(bool signed_a, Value a, bool signed_b, Value b) {
        Recipe::Node low{
            .kind = Kind::LowProduct, .signed_a = signed_a, .signed_b = signed_b, .a = a, .b = b};
        Recipe::Node high = low;
        high.kind = Kind::HighProduct;
        return {node(low), node(high)};
    }
    static Value low(Product product) { return product.low; }
    static Bit bit(Value a, std::uint32_t mask) {
        Bit bit;
        bit.from = Bit::From::Masked;
        bit.a = a;
        bit.mask = static_cast<std::uint16_t>(mask);
        return bit;
    }
    static bool decided(Bit) { throw Stop{}; }
    static Bit equal(bool byte, Value a, Value b) { return compared(Bit::From::Equal, byte, a, b); }
    static Bit less(bool byte, Value a, Value b) { return compared(Bit::From::Less, byte, a, b); }

    // Registers.
    Value whole(int reg) {
        if (reg > 15) throw Stop{};
        for (auto effect = recipe_.effects.rbegin(); effect != recipe_.effects.rend(); ++effect) {
            if (effect->to_memory || effect->place != reg) continue;
            if (effect->byte) throw Stop{};
            return effect->value;
        }
        return node({.kind = Kind::Register, .place = static_cast<std::uint8_t>(reg)});
    }
    Value part(int reg, bool byte) {
        if (!byte) return whole(reg);
        for (const Recipe::Effect& effect : recipe_.effects)
            if (!effect.to_memory && effect.place == reg) throw Stop{};
        return node({.kind = Kind::Register, .byte = true, .place = static_cast<std::uint8_t>(reg)});
    }
    void set_whole(int reg, Value value) { put(reg, false, value); }
    void put(int reg, bool byte, Value value) {
        if (reg > 15) throw Stop{};
        if (reg == 15 && !byte && !is_even(value)) value = conjunction(value, RecipeDomain::value(0xFFFE));
        std::erase_if(recipe_.effects, [&](const Recipe::Effect& effect) {
            return !byte && !effect.to_memory && effect.place == reg;
        });
        recipe_.effects.push_back({false, static_cast<std::uint8_t>(reg), false, byte, value});
    }
    void set_pair(int reg, Product product) {
        set_whole(reg, product.low);
        set_whole(reg + 1, product.high);
    }

    // Memory.
    Value load(const Address& at, bool byte) {
        for (const Recipe::Effect& effect : recipe_.effects)
            if (effect.to_memory) throw Stop{};
        bool second = false;
        const std::uint8_t place = access(at, byte, second);
        recipe_.accesses[place].reads = true;
        return node({.kind = Kind::Cell, .byte = byte, .place = place, .second = second});
    }
    void store(const Address& at, bool byte, Value value) {
        bool second = false;
        const std::uint8_t place = access(at, byte, second);
        recipe_.accesses[place].writes = true;
        recipe_.effects.push_back({true, place, second, byte, value});
    }
    template <class Change>
    void change(const Address& at, bool byte, Change change) {
        store(at, byte, change(load(at, byte)));
    }
    static Address next_word(Address at) {
        at.offset += 2;
        return at;
    }
    Address displaced(int reg, std::uint16_t literal, bool) {
        return {whole(reg), static_cast<std::int16_t>(literal), reg == 15};
    }
    Value plus(Value a, std::uint16_t offset) { return sum_of(a, value(offset)); }

    // Flags.
    static Bit c() {
        Bit bit;
        bit.from = Bit::From::Carry;
        return bit;
    }
    static Bit z() { throw Stop{}; }
    static bool n() { throw Stop{}; }
    static bool ov() { throw Stop{}; }
    static bool dc() { throw Stop{}; }
    static bool daw_clears_carry() { throw Stop{}; }
    static bool accumulator(std::uint16_t) { throw Stop{}; }
    void set_c(Bit bit) { recipe_.c = bit; }
    void set_z(Bit bit) { recipe_.z = bit; }
    Value add(bool byte, bool sticky, Value a, Value b, Bit carry) {
        const Value outcome = node({.kind = Kind::Sum, .byte = byte});
        recipe_.sum = {byte, sticky, a, b, carry, outcome};
        return outcome;
    }
    Value logic(bool byte, Value result) {
        recipe_.result = result;
        recipe_.result_byte = byte;
        return result;
    }
    Value moved(bool byte, Value result) { return logic(byte, result); }
    Value shifted(bool byte, Value result, Bit out) {
        set_c(out);
        return logic(byte, result);
    }

    // Flow.
    const Op* skip_if(const Op* op, Bit condition) {
        recipe_.skips = condition;
        return op + 1;
    }
    const Op* branch(const Op*, bool) { throw Stop{}; }
    void clear_watchdog() { throw Stop{}; }

  private:
    [[noreturn]] static void leave() { throw Stop{}; }
    static Bit compared(Bit::From from, bool byte, Value a, Value b) {
        Bit bit;
        bit.from = from;
        bit.byte = byte;
        bit.a = a;
        bit.b = b;
        return bit;
    }

    Value node(const Recipe::Node& node) {
        recipe_.nodes.push_back(node);
        return {false, static_cast<std::uint16_t>(recipe_.nodes.size() - 1)};
    }
    Value combined(Kind kind, Value a, Value b) {
        if (a.known && b.known) {
            if (kind == Kind::And) return value(a.number & b.number);
            return value(kind == Kind::Ior ? a.number | b.number : a.number ^ b.number);
        }
        return node({.kind = kind, .a = a, .b = b});
    }
    /// W15 has no bit 0, and neither has what comes of it by even steps.
    bool is_even(Value a) const {
        if (a.known) return a.number % 2 == 0;
        const Recipe::Node& node = recipe_.node(a);
        if (node.kind == Kind::Register) return node.place == 15 && !node.byte;
        if (node.kind == Kind::Plus) return is_even(node.a) && is_even(node.b);
        return node.kind == Kind::And && node.b.known && node.b.number % 2 == 0;
    }
    /// a + b, with the constants of both in one.
    Value sum_of(Value a, Value b) {
        if (a.known && b.known) return value(a.number + b.number);
        if (b.known && recipe_.is(a, Kind::Plus) && recipe_.node(a).b.known) {
            const Recipe::Node inner = recipe_.node(a);
            return sum_of(inner.a, value(inner.b.number + b.number));
        }
        return node({.kind = Kind::Plus, .a = a, .b = b});
    }

    Address step_pointer(int reg, int pre, int post) {
        const Value base = whole(reg);
        if (pre + post != 0) {
            Value moved = plus(base, static_cast<std::uint16_t>(pre + post));
            set_whole(reg, moved);
        }
        return {base, pre, reg == 15};
    }
    Address indexed(int reg, int index) { return {sum_of(whole(reg), whole(index)), 0, reg == 15}; }

    std::uint8_t access(const Address& at, bool byte, bool& second) {
        for (std::size_t i = 0; i < recipe_.accesses.size(); ++i) {
            Recipe::Access& known = recipe_.accesses[i];
            if (known.base != at.base || known.byte != byte) continue;
            second = !byte && at.offset == known.offset + 2 && !at.base.known;
            if (!second && at.offset != known.offset) continue;
            known.two = known.two || second;
            return static_cast<std::uint8_t>(i);
        }
        recipe_.accesses.push_back({.base = at.base, .offset = at.offset, .byte = byte, .stack = at.stack});
        return static_cast<std::uint8_t>(recipe_.accesses.size() - 1);
    }

    const Machine& m_;
    Recipe& recipe_;
};

}  // namespace

std::optional<Recipe> recipe_of(const Machine& m, const Op* op) {
    Recipe recipe;
    RecipeDomain domain(m, recipe);
    bool known = false;
    const auto run = [&](auto semantics) {
        semantics.run(domain, op, Decoded(*op));
        known = true;
    };
    try {
        with_move(op->form, run) || with_arithmetic(op->form, run) || with_bits(op->form, run) ||
            with_shift(op->form, run) || with_product(op->form, run);
    } catch (const Stop&) {
        return std::nullopt;
    }
    if (!known) return std::nullopt;
    return recipe;
}

}  // namespace puckloop::dspic::translate
