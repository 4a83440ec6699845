// Code for an instruction from its recipe. Checks come before anything that changes, so that the instruction
// can still be left to the interpreter; then flags, then effects, then whether it skips.

#include "emu/dspic/translate/recipe.h"

#include "emu/dspic/machine/execute/shape.h"
#include "emu/dspic/translate/emitter.h"

#include <algorithm>
#include <bit>

namespace puckloop::dspic::translate {

using namespace Xbyak::util;
using Kind = Recipe::Node::Kind;

namespace {

constexpr int kSkipIfEqual = 4, kSkipUnlessZero = 5, kSkipIfLess = 12;

/// The registers that a value is made of, a bit each.
std::uint32_t registers_in(const Recipe& recipe, const Recipe::Value& value) {
    if (value.known) return 0;
    const Recipe::Node& node = recipe.node(value);
    if (node.kind == Kind::Register) return 1u << node.place;
    if (node.kind == Kind::Cell || node.kind == Kind::Sum) return 0;
    return registers_in(recipe, node.a) | registers_in(recipe, node.b);
}

bool has_cell(const Recipe& recipe, const Recipe::Value& value) {
    if (value.known) return false;
    const Recipe::Node& node = recipe.node(value);
    if (node.kind == Kind::Register || node.kind == Kind::Sum) return false;
    return node.kind == Kind::Cell || has_cell(recipe, node.a) || has_cell(recipe, node.b);
}

bool is_leaf(const Recipe& recipe, const Recipe::Value& value) {
    return value.known || recipe.is(value, Kind::Register) || recipe.is(value, Kind::Cell);
}

/// Whether the value, as computed in 32 bits, has none set beyond the operand's size.
bool fits(const Recipe& recipe, const Recipe::Value& value, bool byte) {
    if (value.known) return value.number <= ones(byte);
    const Recipe::Node& node = recipe.node(value);
    switch (node.kind) {
    case Kind::Register:
    case Kind::Cell:
        return node.byte || !byte;
    case Kind::And:
        return fits(recipe, node.a, byte) || fits(recipe, node.b, byte);
    case Kind::Ior:
    case Kind::Xor:
        return fits(recipe, node.a, byte) && fits(recipe, node.b, byte);
    case Kind::Right:
    case Kind::Halved:
        return fits(recipe, node.a, byte);
    default:
        return false;
    }
}

/// Operations of which code can be made. The second operand is loaded by itself.
bool can_compute(const Recipe& recipe, const Recipe::Value& value) {
    if (is_leaf(recipe, value)) return true;
    const Recipe::Node& node = recipe.node(value);
    const bool stores = std::any_of(recipe.accesses.begin(), recipe.accesses.end(),
                                    [](const Recipe::Access& access) { return access.writes; });
    switch (node.kind) {
    case Kind::Sum:
        return true;
    case Kind::Left:
    case Kind::Right:
    case Kind::SignedRight:  // a count that is not known goes to ecx
        return can_compute(recipe, node.a) && (node.b.known || (!stores && can_compute(recipe, node.b)));
    case Kind::Doubled:
    case Kind::Halved:
        return is_leaf(recipe, node.a) && recipe.result == value;
    case Kind::LowProduct:
    case Kind::HighProduct:
        return is_leaf(recipe, node.a) && is_leaf(recipe, node.b);
    default:
        return can_compute(recipe, node.a) && is_leaf(recipe, node.b) &&
               !recipe.is(node.a, Kind::LowProduct) && !recipe.is(node.a, Kind::HighProduct);
    }
}

}  // namespace

/// Makes the code for one recipe.
class RecipeCode {
  public:
    RecipeCode(Emitter& emitter, const Recipe& recipe) : e_(emitter), r_(recipe) {}

    /// False: there can be no code for it, and none was emitted.
    bool prepare();
    void emit();
    /// The host's condition under which it skips the next instruction; after emit().
    int skip_condition();

  private:
    /// What an address turned out to be.
    struct Place {
        enum class Kind : std::uint8_t { File, Plain, Core, Index } kind = Kind::File;
        int file = 0;
        Emitter::CoreRegister core;
        Xbyak::Reg64 index;
    };

    bool find_place(const Recipe::Access& access);
    void check(const Recipe::Access& access, const Place& place);
    Xbyak::Address cell(const Recipe::Node& node) const { return cell(node.place, node.second, node.byte); }
    Xbyak::Address cell(std::size_t access, bool second, bool byte) const;

    void compute(const Recipe::Value& value, const Xbyak::Reg32& to, const Xbyak::Reg32& scratch);
    /// The value just computed, zero extended from its size.
    void trim(const Recipe::Value& value, const Xbyak::Reg32& in, bool byte);
    void compute_node(const Recipe::Node& node, const Xbyak::Reg32& to, const Xbyak::Reg32& scratch);
    void compute_signed(const Recipe::Value& value, bool is_signed, const Xbyak::Reg32& to);
    void shift(const Recipe::Node& node, const Xbyak::Reg32& to);
    void shift_in(const Recipe::Node& node, const Xbyak::Reg32& to);

    void emit_sum(const Recipe::Sum& sum);
    void emit_result();
    void bit_to_c(const Recipe::Bit& bit);
    void emit_effects();
    void write(std::size_t number);
    bool move_pointer(const Recipe::Effect& effect);
    bool change_file(const Recipe::Effect& effect);
    bool is_written_back(const Recipe::Effect& effect) const;
    /// Where the value is already, or is brought to.
    Xbyak::Reg32 in_register(const Recipe::Value& value);
    Xbyak::Reg32 free_register() const;

    Emitter& e_;
    const Recipe& r_;
    std::vector<Place> places_;
    bool uses_ecx_ = false, uses_edx_ = false;
    /// Values that are in a register.
    struct Held {
        Recipe::Value value;
        Xbyak::Reg32 in;
    };
    std::vector<Held> held_;
    const Held* held(const Recipe::Value& value) const {
        for (const Held& one : held_)
            if (one.value == value) return &one;
        return nullptr;
    }
};

// --- addresses -------------------------------------------------------------------------------------------

bool RecipeCode::find_place(const Recipe::Access& access) {
    Place place;
    if (access.base.known) {
        const std::uint16_t address = access.base.number;
        const std::optional<Emitter::CoreRegister> core = e_.core_register(address);
        if (e_.ram_literal(address, access.byte, place.file)) {
            place.kind = Place::Kind::File;
        } else if (core && !access.byte && access.reads != access.writes) {
            place.kind = Place::Kind::Core;
            place.core = *core;
        } else if (!access.writes && e_.can_read_plain(address, access.byte)) {
            if (uses_ecx_ || uses_edx_) return false;
            uses_ecx_ = true;
            place.kind = Place::Kind::Plain;
        } else {
            return false;
        }
        places_.push_back(place);
        return true;
    }
    // A check may use eax and edx, so the index in edx comes last.
    if (access.reads ? uses_ecx_ || uses_edx_ : uses_edx_) return false;
    (access.reads ? uses_ecx_ : uses_edx_) = true;
    place.kind = Place::Kind::Index;
    place.index = access.reads ? rcx : rdx;
    places_.push_back(place);
    return can_compute(r_, access.base);
}

void RecipeCode::check(const Recipe::Access& access, const Place& place) {
    if (place.kind == Place::Kind::Plain) {
        e_.check_plain(access.base.number);
    } else if (place.kind == Place::Kind::Index) {
        const Xbyak::Reg32 index = place.index.cvt32();
        compute(access.base, eax, index);
        trim(access.base, eax, false);
        if (access.writes || access.stack || access.two)
            e_.ram_index(index, access.offset, access.byte, access.stack, access.two ? 2 : 1);
        else
            return e_.readable_index(access.offset, access.byte);
        // ULNK goes on with what was computed for it.
        const bool alone = places_.size() == 1 && !r_.sum && !r_.result && !r_.c && !r_.z;
        if (alone && !is_leaf(r_, access.base)) held_.push_back({access.base, eax});
    }
}

Xbyak::Address RecipeCode::cell(std::size_t access, bool second, bool byte_size) const {
    const Place& place = places_[access];
    const int behind = second ? 2 : 0;
    switch (place.kind) {
    case Place::Kind::Core:
        return word[rbp + place.core.place];
    case Place::Kind::Plain:
        return e_.plain_cell(r_.accesses[access].base.number, byte_size);
    case Place::Kind::Index:
        return byte_size ? byte[r12 + place.index] : word[r12 + place.index * 2 + behind];
    default:
        return e_.file_cell(place.file, byte_size);
    }
}

bool RecipeCode::prepare() {
    if (!std::all_of(r_.accesses.begin(), r_.accesses.end(),
                     [this](const Recipe::Access& access) { return find_place(access); }))
        return false;
    const auto fine = [this](const Recipe::Value& value) { return can_compute(r_, value); };
    if (r_.result && !fine(*r_.result)) return false;
    if (r_.sum && !(fine(r_.sum->a) && fine(r_.sum->b))) return false;
    for (const auto& bit : {r_.c, r_.skips, r_.z})
        if (bit && !(fine(bit->a) && fine(bit->b))) return false;
    return std::all_of(r_.effects.begin(), r_.effects.end(),
                       [&](const Recipe::Effect& effect) { return fine(effect.value); });
}

// --- values ----------------------------------------------------------------------------------------------

void RecipeCode::compute(const Recipe::Value& value, const Xbyak::Reg32& to, const Xbyak::Reg32& scratch) {
    if (value.known) {
        value.number == 0 ? e_.xor_(to, to) : e_.mov(to, value.number);
    } else if (const Held* here = held(value)) {
        if (here->in != to) e_.mov(to, here->in);
    } else {
        compute_node(r_.node(value), to, scratch);
    }
}

void RecipeCode::trim(const Recipe::Value& value, const Xbyak::Reg32& in, bool byte) {
    if (fits(r_, value, byte)) return;
    byte ? e_.movzx(in, in.cvt8()) : e_.movzx(in, in.cvt16());
}

void RecipeCode::compute_node(const Recipe::Node& node, const Xbyak::Reg32& to, const Xbyak::Reg32& scratch) {
    const auto with_second = [&](auto operation) {
        compute(node.a, to, scratch);
        if (node.b.known) return operation(Xbyak::Operand(), true);
        compute(node.b, scratch, scratch);
        operation(scratch, false);
    };
    const std::uint32_t second = node.b.number;
    switch (node.kind) {
    case Kind::Register:
        return e_.load_w(to, node.place, node.byte);
    case Kind::Cell:
        return e_.movzx(to, cell(node));
    case Kind::Plus:
        return with_second([&](const Xbyak::Operand& b, bool known) {
            known ? e_.add(to, static_cast<std::uint32_t>(static_cast<std::int16_t>(second))) : e_.add(to, b);
        });
    case Kind::And:
        return with_second(
            [&](const Xbyak::Operand& b, bool known) { known ? e_.and_(to, second) : e_.and_(to, b); });
    case Kind::Ior:
        return with_second(
            [&](const Xbyak::Operand& b, bool known) { known ? e_.or_(to, second) : e_.or_(to, b); });
    case Kind::Xor:
        return with_second(
            [&](const Xbyak::Operand& b, bool known) { known ? e_.xor_(to, second) : e_.xor_(to, b); });
    case Kind::Left:
    case Kind::Right:
    case Kind::SignedRight:
        return shift(node, to);
    case Kind::Doubled:
    case Kind::Halved:
        return shift_in(node, to);
    case Kind::SignExtended:
        return r_.is(node.a, Kind::Register) ? e_.movsx(to, e_.w_byte(r_.node(node.a).place))
                                             : e_.movsx(to, cell(r_.node(node.a)));
    case Kind::Swapped:
        compute(node.a, to, scratch);
        node.byte ? e_.rol(to.cvt8(), 4) : e_.rol(to.cvt16(), 8);
        return;
    case Kind::LowProduct:
    case Kind::HighProduct:
        compute_signed(node.b, node.signed_b, edx);
        compute_signed(node.a, node.signed_a, eax);
        e_.imul(eax, edx);
        if (node.kind == Kind::HighProduct) e_.shr(eax, 16);
        return;
    case Kind::Sum:
        return;  // held
    }
}

void RecipeCode::compute_signed(const Recipe::Value& value, bool is_signed, const Xbyak::Reg32& to) {
    if (is_signed && r_.is(value, Kind::Register)) return e_.movsx(to, e_.w_word(r_.node(value).place));
    compute(value, to, to);
    if (is_signed) e_.movsx(to, to.cvt16());
}

void RecipeCode::shift(const Recipe::Node& node, const Xbyak::Reg32& to) {
    const bool count_first = !r_.is(node.a, Kind::Cell);  // which ecx leads to
    if (!node.b.known && count_first) compute(node.b, ecx, ecx);
    compute_signed(node.a, node.kind == Kind::SignedRight, to);
    if (!node.b.known && !count_first) compute(node.b, ecx, ecx);
    const auto by = [&](auto literal, auto counted) { node.b.known ? literal(node.b.number) : counted(); };
    switch (node.kind) {
    case Kind::Left:
        return by([&](int n) { e_.shl(to, n); }, [&] { e_.shl(to, cl); });
    case Kind::Right:
        return by([&](int n) { e_.shr(to, n); }, [&] { e_.shr(to, cl); });
    default:
        return by([&](int n) { e_.sar(to, n); }, [&] { e_.sar(to, cl); });
    }
}

/// The operand is in eax, which this uses up; the old carry, if it is shifted in, in `to`.
void RecipeCode::shift_in(const Recipe::Node& node, const Xbyak::Reg32& to) {
    const int highest = node.byte ? 7 : 15;
    const Recipe::Bit& in = node.in;
    const bool own = in.from == Recipe::Bit::From::Masked;
    if (node.kind == Kind::Doubled) {
        if (in.is(false)) return e_.lea(to, ptr[rax + rax]);
        if (own) {
            e_.mov(to, eax);
            e_.shr(to, highest);
        }
        return e_.lea(to, ptr[to.cvt64() + rax * 2]);
    }
    if (in.is(false)) {
        e_.mov(to, eax);
        return e_.shr(to, 1);
    }
    if (own && in.mask == top(node.byte)) {
        node.byte ? e_.movsx(to, al) : e_.movsx(to, ax);
        e_.sar(to, 1);
        return e_.and_(to, ones(node.byte));
    }
    if (own) {
        e_.mov(to, eax);
        e_.and_(to, 1);
    }
    e_.shl(to, highest);
    e_.shr(eax, 1);
    e_.or_(to, eax);
}

// --- flags -----------------------------------------------------------------------------------------------

void RecipeCode::emit_sum(const Recipe::Sum& sum) {
    compute(sum.a, r8d, eax);
    compute(sum.b, r9d, eax);
    if (sum.carry.from == Recipe::Bit::From::Carry) {
        e_.carry_to(eax);  // from SR: flush_flags() came first
        e_.lea(r10d, ptr[r8 + r9]);
        e_.add(r10d, eax);
        e_.set_sum(sum.byte, -1, sum.sticky);
    } else {
        const int carry = sum.carry.is(true) ? 1 : 0;
        e_.lea(r10d, ptr[r8 + r9 + carry]);
        e_.set_sum(sum.byte, carry, sum.sticky);
    }
    held_.push_back({sum.outcome, r10d});
}

/// Results are in r11d, the bit for C in esi.
void RecipeCode::emit_result() {
    const bool shifts = r_.result && (r_.is(*r_.result, Kind::Doubled) || r_.is(*r_.result, Kind::Halved));
    if (shifts) {
        const Recipe::Node& node = r_.node(*r_.result);
        compute(node.a, eax, eax);
        held_.push_back({node.a, eax});
        if (node.in.from == Recipe::Bit::From::Carry) e_.carry_to(r11d);
    }
    const bool of_result = r_.c && r_.result && r_.c->a == *r_.result;
    if (r_.c && !of_result) bit_to_c(*r_.c);
    if (r_.result) {
        compute(*r_.result, r11d, eax);
        trim(*r_.result, r11d, r_.result_byte);
        e_.set_result(r_.result_byte);
        held_.clear();
        held_.push_back({*r_.result, r11d});
    }
    if (of_result) bit_to_c(*r_.c);
    if (r_.z) {  // the complement of a bit
        compute(r_.z->a, r11d, eax);
        e_.and_(r11d, r_.z->mask);
        e_.flags_.z = Flags::From::Result;
    }
}

void RecipeCode::bit_to_c(const Recipe::Bit& bit) {
    compute(bit.a, esi, esi);
    if (const int place = std::countr_zero(bit.mask); place > 0) e_.shr(esi, place);
    e_.and_(esi, 1);
    if (bit.inverted) e_.xor_(esi, 1);
    e_.flags_.c = Flags::From::Bit;
}

// --- effects ---------------------------------------------------------------------------------------------

Xbyak::Reg32 RecipeCode::free_register() const {
    const auto is_held = [this](const Xbyak::Reg32& reg) {
        return std::any_of(held_.begin(), held_.end(), [&](const Held& one) { return one.in == reg; });
    };
    if (!is_held(eax)) return eax;
    if (!uses_ecx_ && !is_held(ecx)) return ecx;
    return edx;
}

Xbyak::Reg32 RecipeCode::in_register(const Recipe::Value& value) {
    if (const Held* here = held(value)) return here->in;
    const Xbyak::Reg32 to = free_register();
    compute(value, to, to == eax ? ecx : eax);
    return to;
}

/// A pointer that moves, in place.
bool RecipeCode::move_pointer(const Recipe::Effect& effect) {
    if (effect.value.known || effect.byte) return false;
    const auto own_step = [&](const Recipe::Value& value) {
        const Recipe::Node& node = r_.node(value);
        return node.kind == Kind::Plus && node.b.known && r_.is(node.a, Kind::Register) &&
               r_.node(node.a).place == effect.place;
    };
    Recipe::Value moved = effect.value;
    const bool even = effect.place == 15 && r_.is(moved, Kind::And);  // by one byte
    if (even) moved = r_.node(moved).a;
    if (moved.known || !own_step(moved)) return false;
    const auto step = static_cast<std::int16_t>(r_.node(moved).b.number);
    if (step != 0) e_.add(e_.w_word(effect.place), step);
    if (even) e_.and_(e_.w_word(effect.place), -2);
    return true;
}

/// A bit of a byte in RAM, as a word: a later load of it would wait for a store of half of it.
bool RecipeCode::change_file(const Recipe::Effect& effect) {
    const Place& place = places_[effect.place];
    if (!effect.byte || place.kind != Place::Kind::File || effect.value.known || held(effect.value))
        return false;
    const Recipe::Node& node = r_.node(effect.value);
    if (!node.b.known || !r_.is(node.a, Kind::Cell) || r_.node(node.a).place != effect.place) return false;
    const int shift = place.file & 1 ? 8 : 0;
    const std::uint32_t mask = (node.b.number & 0xFFu) << shift;
    const Xbyak::Address whole = e_.file_cell(place.file & ~1, false);
    if (node.kind != Kind::And && node.kind != Kind::Ior && node.kind != Kind::Xor) return false;
    e_.movzx(eax, whole);
    if (node.kind == Kind::And)
        e_.and_(eax, mask | 0xFFu << (8 - shift));
    else
        node.kind == Kind::Ior ? e_.or_(eax, mask) : e_.xor_(eax, mask);
    e_.mov(whole, ax);
    return true;
}

/// RAM gets what it holds.
bool RecipeCode::is_written_back(const Recipe::Effect& effect) const {
    if (!r_.is(effect.value, Kind::Cell)) return false;
    const Recipe::Node& node = r_.node(effect.value);
    return node.place == effect.place && node.second == effect.second;
}

void RecipeCode::write(std::size_t number) {
    const Recipe::Effect& effect = r_.effects[number];
    if (effect.to_memory) {
        if (is_written_back(effect) || change_file(effect)) return;
        const Xbyak::Reg32 from = in_register(effect.value);
        if (const Place& place = places_[effect.place]; place.kind == Place::Kind::Core)
            e_.and_(from, place.core.bits);
        const Xbyak::Address to = cell(effect.place, effect.second, effect.byte);
        effect.byte ? e_.mov(to, from.cvt8()) : e_.mov(to, from.cvt16());
        return;
    }
    if (move_pointer(effect)) return;
    if (r_.is(effect.value, Kind::LowProduct) && number + 1 < r_.effects.size() &&
        r_.is(r_.effects[number + 1].value, Kind::HighProduct)) {
        compute(effect.value, eax, eax);
        return e_.mov(e_.w_double(effect.place), eax);
    }
    if (r_.is(effect.value, Kind::HighProduct)) return;
    const Xbyak::Reg32 from = in_register(effect.value);
    if (!effect.byte) return e_.mov(e_.w_word(effect.place), from.cvt16());
    e_.mov(e_.w_byte(effect.place), from.cvt8());
    if (effect.place == 15) e_.and_(e_.w_byte(15), 0xFE);
}

void RecipeCode::emit_effects() {
    // What an earlier effect would overwrite is loaded before.
    std::uint32_t written = 0;
    bool stored = false;
    for (const Recipe::Effect& effect : r_.effects) {
        const Recipe::Value& value = effect.value;
        const bool lost = registers_in(r_, value) & written || (stored && has_cell(r_, value));
        if (lost && !held(value) && !r_.is(value, Kind::HighProduct))
            held_.push_back({value, in_register(value)});
        if (effect.to_memory)
            stored = true;
        else
            written |= 1u << effect.place;
    }
    if (r_.skips && !r_.effects.empty()) held_.push_back({r_.skips->a, in_register(r_.skips->a)});
    for (std::size_t i = 0; i < r_.effects.size(); ++i)
        write(i);
}

void RecipeCode::emit() {
    const bool after_others = r_.sum && (r_.sum->sticky || r_.sum->carry.from == Recipe::Bit::From::Carry);
    const bool z_alone = r_.z && e_.flags_.n == Flags::From::Result;  // r11 is wanted for Z alone
    if (after_others || z_alone) e_.flush_flags();
    for (std::size_t i = 0; i < places_.size(); ++i)
        check(r_.accesses[i], places_[i]);
    if (r_.sum) emit_sum(*r_.sum);
    emit_result();
    emit_effects();
}

int RecipeCode::skip_condition() {
    const Recipe::Bit& bit = *r_.skips;
    int host = kSkipUnlessZero;
    if (bit.from == Recipe::Bit::From::Masked) {
        if (const Held* here = held(bit.a))
            e_.test(here->in, bit.mask);
        else if (r_.is(bit.a, Kind::Cell) && r_.node(bit.a).byte)
            e_.test(cell(r_.node(bit.a)), bit.mask);
        else
            e_.test(in_register(bit.a), bit.mask);
    } else {
        const auto operand = [&](const Recipe::Value& value) {
            return bit.byte ? e_.w_byte(r_.node(value).place) : e_.w_word(r_.node(value).place);
        };
        const Xbyak::Reg first = bit.byte ? Xbyak::Reg(al) : Xbyak::Reg(ax);
        e_.mov(first, operand(bit.a));
        e_.cmp(first, operand(bit.b));
        host = bit.from == Recipe::Bit::From::Equal ? kSkipIfEqual : kSkipIfLess;
    }
    return bit.inverted ? host ^ 1 : host;
}

bool Emitter::emit_recipe(const Op* op) {
    const std::optional<Recipe> recipe = recipe_of(*machine_, op);
    if (!recipe) return false;
    const std::uint32_t over = recipe->skips && is_two_words(machine_->code[index_ + 1].word) ? 2 : 1;
    if (recipe->skips && index_ + 1 + over >= layout_.code_words) return false;
    RecipeCode code(*this, *recipe);
    if (!code.prepare()) return false;
    code.emit();
    if (recipe->skips) side_exit(op, code.skip_condition(), index_ + 1 + over, over);
    return true;
}

}  // namespace puckloop::dspic::translate
