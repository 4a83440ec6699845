// Moves between registers, data space, I/O space and program memory; single bits.

#include "emu/avr/machine/execute/handlers.h"

namespace puckloop::avr::execute {

namespace {

/// How an access leaves its pointer register.
enum class Pointer : std::uint8_t { Plain, Increment, Decrement };

/// The address that an instruction with this pointer uses; the pointer moves.
template <std::uint8_t kRegister, Pointer kMove>
std::uint16_t address_of(Machine& m) {
    const std::uint16_t before = pair(m, kRegister);
    if constexpr (kMove == Pointer::Increment) set_pair(m, kRegister, before + 1u);
    if constexpr (kMove != Pointer::Decrement) return before;
    set_pair(m, kRegister, before - 1u);
    return static_cast<std::uint16_t>(before - 1);
}

template <std::uint8_t kRegister, Pointer kMove>
const Op* load_by(Machine& m, const Op* op) {
    const std::uint16_t address = address_of<kRegister, kMove>(m);
    set_rd(m, op, load(m, op, address));
    return op + 1;
}

template <std::uint8_t kRegister, Pointer kMove>
const Op* store_by(Machine& m, const Op* op) {
    const std::uint8_t value = rr(m, op);  // as it was, even where it is half of the pointer
    const std::uint16_t address = address_of<kRegister, kMove>(m);
    store(m, op, address, value);
    return op + 1;
}

std::uint16_t displaced(const Machine& m, std::uint8_t pointer, const Op* op) {
    return static_cast<std::uint16_t>(pair(m, pointer) + op->k);
}

std::uint32_t extended_z(const Machine& m) {
    return static_cast<std::uint32_t>(m.rampz) << 16 | pair(m, kZ);
}

}  // namespace

const Op* MOV(Machine& m, const Op* op) {
    set_rd(m, op, rr(m, op));
    return op + 1;
}
const Op* MOVW(Machine& m, const Op* op) {
    set_pair(m, op->d, pair(m, op->r));
    return op + 1;
}
const Op* LDI(Machine& m, const Op* op) {
    set_rd(m, op, k8(op));
    return op + 1;
}

const Op* LDS(Machine& m, const Op* op) {
    set_rd(m, op, load(m, op, op->k));
    return op + 2;
}
const Op* LD_X(Machine& m, const Op* op) {
    return load_by<kX, Pointer::Plain>(m, op);
}
const Op* LD_X_INC(Machine& m, const Op* op) {
    return load_by<kX, Pointer::Increment>(m, op);
}
const Op* LD_X_DEC(Machine& m, const Op* op) {
    return load_by<kX, Pointer::Decrement>(m, op);
}
const Op* LD_Y_INC(Machine& m, const Op* op) {
    return load_by<kY, Pointer::Increment>(m, op);
}
const Op* LD_Y_DEC(Machine& m, const Op* op) {
    return load_by<kY, Pointer::Decrement>(m, op);
}
const Op* LDD_Y(Machine& m, const Op* op) {
    set_rd(m, op, load(m, op, displaced(m, kY, op)));
    return op + 1;
}
const Op* LD_Z_INC(Machine& m, const Op* op) {
    return load_by<kZ, Pointer::Increment>(m, op);
}
const Op* LD_Z_DEC(Machine& m, const Op* op) {
    return load_by<kZ, Pointer::Decrement>(m, op);
}
const Op* LDD_Z(Machine& m, const Op* op) {
    set_rd(m, op, load(m, op, displaced(m, kZ, op)));
    return op + 1;
}

const Op* STS(Machine& m, const Op* op) {
    store(m, op, op->k, rr(m, op));
    return op + 2;
}
const Op* ST_X(Machine& m, const Op* op) {
    return store_by<kX, Pointer::Plain>(m, op);
}
const Op* ST_X_INC(Machine& m, const Op* op) {
    return store_by<kX, Pointer::Increment>(m, op);
}
const Op* ST_X_DEC(Machine& m, const Op* op) {
    return store_by<kX, Pointer::Decrement>(m, op);
}
const Op* ST_Y_INC(Machine& m, const Op* op) {
    return store_by<kY, Pointer::Increment>(m, op);
}
const Op* ST_Y_DEC(Machine& m, const Op* op) {
    return store_by<kY, Pointer::Decrement>(m, op);
}
const Op* STD_Y(Machine& m, const Op* op) {
    store(m, op, displaced(m, kY, op), rr(m, op));
    return op + 1;
}
const Op* ST_Z_INC(Machine& m, const Op* op) {
    return store_by<kZ, Pointer::Increment>(m, op);
}
const Op* ST_Z_DEC(Machine& m, const Op* op) {
    return store_by<kZ, Pointer::Decrement>(m, op);
}
const Op* STD_Z(Machine& m, const Op* op) {
    store(m, op, displaced(m, kZ, op), rr(m, op));
    return op + 1;
}

const Op* PUSH(Machine& m, const Op* op) {
    push(m, op, rr(m, op));
    return op + 1;
}
const Op* POP(Machine& m, const Op* op) {
    set_rd(m, op, pop(m, op));
    return op + 1;
}

const Op* IN(Machine& m, const Op* op) {
    set_rd(m, op, load(m, op, op->k));
    return op + 1;
}
const Op* OUT(Machine& m, const Op* op) {
    store(m, op, op->k, rr(m, op));
    return op + 1;
}
/// SBI and CBI write one bit: flags beside it that a written one would clear stay.
const Op* SBI(Machine& m, const Op* op) {
    store_outside_ram(m, op, op->k, 0xFF, op->b);
    return op + 1;
}
const Op* CBI(Machine& m, const Op* op) {
    store_outside_ram(m, op, op->k, 0, op->b);
    return op + 1;
}

const Op* LPM_R0(Machine& m, const Op* op) {
    m.data[0] = load_program(m, op, pair(m, kZ));
    return op + 1;
}
const Op* LPM(Machine& m, const Op* op) {
    set_rd(m, op, load_program(m, op, pair(m, kZ)));
    return op + 1;
}
const Op* LPM_INC(Machine& m, const Op* op) {
    const std::uint16_t z = pair(m, kZ);
    set_pair(m, kZ, z + 1u);
    set_rd(m, op, load_program(m, op, z));
    return op + 1;
}
const Op* ELPM_R0(Machine& m, const Op* op) {
    m.data[0] = load_program(m, op, extended_z(m));
    return op + 1;
}
const Op* ELPM(Machine& m, const Op* op) {
    set_rd(m, op, load_program(m, op, extended_z(m)));
    return op + 1;
}
const Op* ELPM_INC(Machine& m, const Op* op) {
    const std::uint32_t z = extended_z(m);
    set_pair(m, kZ, z + 1);
    m.rampz = static_cast<std::uint8_t>((z + 1) >> 16 & 1);
    set_rd(m, op, load_program(m, op, z));
    return op + 1;
}
const Op* SPM(Machine& m, const Op* op) {
    m.current = op;
    m.now = m.cycle;
    if (m.hooks.spm) m.hooks.spm(extended_z(m), pair(m, 0));
    return op + 1;
}

const Op* BST(Machine& m, const Op* op) {
    set_flags(m, sreg::T, rd(m, op) & op->b ? sreg::T : 0);
    return op + 1;
}
const Op* BLD(Machine& m, const Op* op) {
    const int others = rd(m, op) & ~op->b;
    set_rd(m, op, static_cast<std::uint8_t>(others | (m.sreg & sreg::T ? op->b : 0)));
    return op + 1;
}
const Op* BSET(Machine& m, const Op* op) {
    write_sreg(m, op, m.sreg | op->b);
    return op + 1;
}
const Op* BCLR(Machine& m, const Op* op) {
    m.sreg = static_cast<std::uint8_t>(m.sreg & ~op->b);
    return op + 1;
}

}  // namespace puckloop::avr::execute
