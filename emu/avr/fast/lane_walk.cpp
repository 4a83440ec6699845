// The instructions over lanes: those of a waiting program. The formulas are the interpreter's (core/alu.h).

#include "emu/avr/fast/lane_walk.h"

#include <algorithm>

namespace puckloop::avr {

namespace {

/// Fewer turns than these are executed one by one.
constexpr Cycle kFewestTurns = 4;
constexpr std::uint8_t k0 = 0, k1 = 1;

}  // namespace

LaneWalk::Verdict LaneWalk::run(const Op* branch, const Op* head, LoopInfo& loop) {
    base_ = m_.cycle;
    period_ = loop.period;
    if (m_.limit <= base_ + kFewestTurns * period_ || m_.irq.any()) return Verdict::NotNow;
    sp_ = m_.sp;
    sreg_ = Lanes(m_.sreg);
    try {
        for (const Op* op = head;;) {
            const Op* const next = execute(op);
            ++instructions_;
            const bool round = op == branch && next == head;
            op = next;
            if (round) break;
            if (instructions_ == kMostInstructions || valid_ == 0) return Verdict::NotNow;
        }
    } catch (const Stop& stop) {
        return stop.verdict;
    }
    loop.period = static_cast<std::uint32_t>(offset_);
    if (offset_ != period_ && follows_)
        valid_ = std::min<std::size_t>(valid_, 1);  // looked at wrong instants
    compare_ends();
    // A turn that reads nothing new and changes nothing is every turn.
    const bool steady = !follows_ && valid_ == Lanes::kCount;
    const std::uint64_t room = (m_.limit - base_) / offset_;
    const std::uint64_t turns = steady ? room : std::min<std::uint64_t>(room, valid_);
    if (turns == 0) return Verdict::NotNow;
    commit(steady ? 0 : turns - 1, turns);
    if (steady) note_steady(branch, head);
    return turns >= kFewestTurns || period_ == 0 ? Verdict::Skipped : Verdict::NotNow;
}

/// A program that comes back to the same loop with the same registers has not left it, as far as one can see.
void LaneWalk::note_steady(const Op* branch, const Op* head) {
    SteadyLoop& loop = m_.steady;
    std::uint32_t fingerprint = 2166136261u;
    for (std::size_t i = 0; i < r_.size(); ++i)
        fingerprint = (fingerprint ^ m_.data[i]) * 16777619u;
    fingerprint = (fingerprint ^ m_.sp) * 16777619u;
    const std::uint16_t at = m_.pc_of(branch);
    if (loop.branch != at || loop.registers != fingerprint) {
        loop = {m_.pc_of(head), at, polled_, cells_ > 0, fingerprint, base_, 0};
    }
    loop.until = m_.cycle;
}

const Op* LaneWalk::put(const Op* op, const Alu<Lanes>& result, std::uint8_t mask) {
    set(op->d, result.value);
    set_flags(mask, result.flags & mask);
    offset_ += op->cycles;
    return op + 1;
}

const Op* LaneWalk::compare(const Op* op, const Alu<Lanes>& result) {
    set_flags(kHsvnzc, result.flags);
    offset_ += op->cycles;
    return op + 1;
}

const Op* LaneWalk::branch_if(bool taken, const Op* op) {
    offset_ += op->cycles + (taken ? 1u : 0u);
    return taken ? m_.code + op->k : op + 1;
}

const Op* LaneWalk::skip_if(bool skipped, const Op* op) {
    offset_ += op->cycles + (skipped ? op->skip - 1u : 0u);
    return skipped ? op + op->skip : op + 1;
}

/// ADIW and SBIW (then the addend is negative): flags as the interpreter has them.
void LaneWalk::add_word(const Op* op, std::uint16_t addend) {
    const bool subtracts = addend >> 15;
    const Lanes low = reg(op->d), high = reg(op->d + 1u);
    const Lanes constant(static_cast<std::uint8_t>(op->k));
    const Alu<Lanes> first = subtracts ? subtract(low, constant, Lanes(k0)) : add(low, constant, Lanes(k0));
    const Lanes carried = first.flags & sreg::C;
    const Alu<Lanes> second = subtracts ? subtract(high, Lanes(k0), carried) : add(high, Lanes(k0), carried);
    const Lanes zero = zero_flag(first.value | second.value);
    set(op->d, first.value);
    set(op->d + 1u, second.value);
    set_flags(kSvnzc, (second.flags & static_cast<std::uint8_t>(kSvnzc & ~sreg::Z)) | zero);
}

void LaneWalk::multiply(const Lanes& d, const Lanes& r) {
    std::array<std::uint8_t, Lanes::kCount> low{}, high{}, flags{};
    for (std::size_t i = 0; i < Lanes::kCount; ++i) {
        const int product = d[i] * r[i];
        low[i] = static_cast<std::uint8_t>(product);
        high[i] = static_cast<std::uint8_t>(product >> 8);
        flags[i] = static_cast<std::uint8_t>((product == 0 ? sreg::Z : 0) | (product >> 15 ? sreg::C : 0));
    }
    set(0, Lanes::of(low));
    set(1, Lanes::of(high));
    set_flags(sreg::Z | sreg::C, Lanes::of(flags));
}

const Op* LaneWalk::execute(const Op* op) {
    const auto d = [&] { return reg(op->d); };
    const auto r = [&] { return reg(op->r); };
    const auto k = [&] { return Lanes(static_cast<std::uint8_t>(op->k)); };
    const auto carry = [&] { return flags(sreg::C); };
    const auto chain = [&](const Alu<Lanes>& result) { return chained(result, flags(sreg::Z)); };
    const auto done = [&](int words = 1) {
        offset_ += op->cycles;
        return op + words;
    };
    const auto loaded = [&](std::uint16_t address, int words = 1) {
        const Lanes value = load(op, address);
        set(op->d, value);
        return done(words);
    };
    const auto stored = [&](std::uint16_t address, const Lanes& value, int words = 1) {
        store(op, address, value);
        return done(words);
    };
    const auto displaced = [&](unsigned low) { return static_cast<std::uint16_t>(pointer(low) + op->k); };
    const Lanes zero_byte(k0);
    using enum FormId;
    switch (op->form) {
        // clang-format off
    case ADD: return put(op, add(d(), r(), zero_byte), kHsvnzc);
    case ADC: return put(op, add(d(), r(), carry()), kHsvnzc);
    case SUB: return put(op, subtract(d(), r(), zero_byte), kHsvnzc);
    case SUBI: return put(op, subtract(d(), k(), zero_byte), kHsvnzc);
    case SBC: return put(op, chain(subtract(d(), r(), carry())), kHsvnzc);
    case SBCI: return put(op, chain(subtract(d(), k(), carry())), kHsvnzc);
    case NEG: return put(op, subtract(zero_byte, d(), zero_byte), kHsvnzc);
    case CP: return compare(op, subtract(d(), r(), zero_byte));
    case CPI: return compare(op, subtract(d(), k(), zero_byte));
    case CPC: return compare(op, chain(subtract(d(), r(), carry())));
    case ADIW: add_word(op, op->k); return done();
    case SBIW: add_word(op, static_cast<std::uint16_t>(0x8000 | op->k)); return done();
    case INC: return put(op, count(d() + Lanes(k1), 0x80), kSvnz);
    case DEC: return put(op, count(d() - Lanes(k1), 0x7F), kSvnz);
    case AND: return put(op, logic(d() & r()), kSvnz);
    case ANDI: return put(op, logic(d() & k()), kSvnz);
    case OR: return put(op, logic(d() | r()), kSvnz);
    case ORI: return put(op, logic(d() | k()), kSvnz);
    case EOR: if (op->d == op->r) return put(op, logic(zero_byte), kSvnz);  // CLR reads nothing
              return put(op, logic(d() ^ r()), kSvnz);
    case COM: { Alu<Lanes> result = logic(~d()); result.flags = result.flags | sreg::C; return put(op, result, kSvnzc); }
    case LSR: return put(op, shift_right(d(), zero_byte), kSvnzc);
    case ROR: return put(op, shift_right(d(), carry() << 7), kSvnzc);
    case ASR: return put(op, shift_right(d(), d() & std::uint8_t{0x80}), kSvnzc);
    case SWAP: set(op->d, d() << 4 | d() >> 4); return done();
    case MUL: multiply(d(), r()); return done();
    case MOV: set(op->d, r()); return done();
    case MOVW: { const Lanes low = r(), high = reg(op->r + 1u); set(op->d, low); set(op->d + 1u, high); return done(); }
    case LDI: set(op->d, k()); return done();
    case BST: { const Lanes off = (d() & op->b).is_zero(); set_flags(sreg::T, ~off & sreg::T); return done(); }
    case BLD: { const Lanes on = ~flags(sreg::T).is_zero() & op->b; set(op->d, (d() & static_cast<std::uint8_t>(~op->b)) | on); return done(); }
    case BSET: write_flags(op, Lanes(op->b), op->b); return done();
    case BCLR: set_flags(op->b, zero_byte); return done();
    case NOP: return done();

    case LDS: return loaded(op->k, 2);
    case IN: return loaded(op->k);
    case LD_X: return loaded(pointer(kX));
    case LD_X_INC: return loaded(moved_pointer(kX, 0, 1));
    case LD_X_DEC: return loaded(moved_pointer(kX, -1, 0));
    case LD_Y_INC: return loaded(moved_pointer(kY, 0, 1));
    case LD_Y_DEC: return loaded(moved_pointer(kY, -1, 0));
    case LDD_Y: return loaded(displaced(kY));
    case LD_Z_INC: return loaded(moved_pointer(kZ, 0, 1));
    case LD_Z_DEC: return loaded(moved_pointer(kZ, -1, 0));
    case LDD_Z: return loaded(displaced(kZ));
    case POP: return loaded(++sp_);
    case STS: return stored(op->k, r(), 2);
    case OUT: return stored(op->k, r());
    case ST_X: return stored(pointer(kX), r());
    case ST_X_INC: { const Lanes value = r(); return stored(moved_pointer(kX, 0, 1), value); }
    case ST_X_DEC: { const Lanes value = r(); return stored(moved_pointer(kX, -1, 0), value); }
    case ST_Y_INC: { const Lanes value = r(); return stored(moved_pointer(kY, 0, 1), value); }
    case ST_Y_DEC: { const Lanes value = r(); return stored(moved_pointer(kY, -1, 0), value); }
    case STD_Y: return stored(displaced(kY), r());
    case ST_Z_INC: { const Lanes value = r(); return stored(moved_pointer(kZ, 0, 1), value); }
    case ST_Z_DEC: { const Lanes value = r(); return stored(moved_pointer(kZ, -1, 0), value); }
    case STD_Z: return stored(displaced(kZ), r());
    case PUSH: return stored(sp_--, r());

    case RJMP: case JMP: offset_ += op->cycles; return m_.code + op->k;
    case BRBS: return branch_if(!zero(flags(op->b)), op);
    case BRBC: return branch_if(zero(flags(op->b)), op);
    case CPSE: return skip_if(zero(d() ^ r()), op);
    case SBRC: return skip_if(zero(r() & op->b), op);
    case SBRS: return skip_if(!zero(r() & op->b), op);
    case SBIC: return skip_if(zero(load(op, op->k) & op->b), op);
    case SBIS: return skip_if(!zero(load(op, op->k) & op->b), op);
        // clang-format on
    case CALL:
    case RCALL:
    case ICALL: {
        const std::uint16_t to = op->form == ICALL ? pointer(kZ) : op->k;
        const auto from = static_cast<std::uint16_t>(m_.pc_of(op) + (op->form == CALL ? 2 : 1));
        store(op, sp_--, Lanes(static_cast<std::uint8_t>(from)));
        store(op, sp_--, Lanes(static_cast<std::uint8_t>(from >> 8)));
        offset_ += op->cycles;
        return m_.code + to;
    }
    case RET: {
        const std::uint8_t high = uniform(load(op, ++sp_)), low = uniform(load(op, ++sp_));
        offset_ += op->cycles;
        return m_.code + (high << 8 | low);
    }
    case Undefined:  // never executed yet, or a stop address
        fail(Verdict::NotNow);
    default:
        fail(Verdict::Never);
    }
}

}  // namespace puckloop::avr
