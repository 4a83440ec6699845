// The core's own registers in the SFR space, 0x0000 to 0x0053.

#include "emu/dspic/core/machine.h"

namespace puckloop::dspic {

namespace {

enum : std::uint16_t {
    kSplim = 0x020,
    kAccal = 0x022,
    kAccah = 0x024,
    kAccau = 0x026,
    kAccbl = 0x028,
    kAccbh = 0x02A,
    kAccbu = 0x02C,
    kPcl = 0x02E,
    kPch = 0x030,
    kTblpag = 0x032,
    kPsvpag = 0x034,
    kRcount = 0x036,
    kDcount = 0x038,
    kDostartl = 0x03A,
    kDostarth = 0x03C,
    kDoendl = 0x03E,
    kDoendh = 0x040,
    kSr = 0x042,
    kCorcon = 0x044,
    kModcon = 0x046,
    kXmodsrt = 0x048,
    kXmodend = 0x04A,
    kYmodsrt = 0x04C,
    kYmodend = 0x04E,
    kXbrev = 0x050,
    kDisicnt = 0x052,
    kLast = 0x052,
};

std::uint16_t accumulator_part(const CoreState& st, std::uint16_t address) {
    const std::int64_t acc = st.acc[address >= kAccbl];
    const int part = (address - (address >= kAccbl ? kAccbl : kAccal)) / 2;
    return static_cast<std::uint16_t>(acc >> (16 * part));  // the upper byte reads sign extended
}

std::uint16_t read_register(void* owner, std::uint16_t address) {
    const auto& m = *static_cast<const Machine*>(owner);
    const CoreState& st = m.st;
    const auto low = [](std::uint32_t a) { return static_cast<std::uint16_t>(a); };
    const auto high = [](std::uint32_t a) { return static_cast<std::uint16_t>(a >> 16); };
    if (address < kSplim) return st.w[address >> 1];
    switch (address) {
    case kSplim:
        return st.splim;
    case kAccal:
    case kAccah:
    case kAccau:
    case kAccbl:
    case kAccbh:
    case kAccbu:
        return accumulator_part(st, address);
    case kPcl:
        return low(m.pc_of(m.current));
    case kPch:
        return high(m.pc_of(m.current));
    case kTblpag:
        return st.tblpag;
    case kPsvpag:
        return st.psvpag;
    case kRcount:
        return st.rcount;
    case kDcount:
        return st.loop.dcount;
    case kDostartl:
        return low(st.loop.dostart);
    case kDostarth:
        return high(st.loop.dostart);
    case kDoendl:
        return low(st.loop.doend);
    case kDoendh:
        return high(st.loop.doend);
    case kSr:
        return st.sr;
    case kCorcon:
        return st.corcon & ~corcon::EDT;
    case kModcon:
        return st.modcon;
    case kXmodsrt:
        return st.xmodsrt;
    case kXmodend:
        return st.xmodend;
    case kYmodsrt:
        return st.ymodsrt;
    case kYmodend:
        return st.ymodend;
    case kXbrev:
        return st.xbrev;
    case kDisicnt:
        return static_cast<std::uint16_t>(st.disi_end > st.cycle ? st.disi_end - st.cycle : 0);
    default:
        return 0;
    }
}

void write_accumulator(CoreState& st, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    std::int64_t& acc = st.acc[address >= kAccbl];
    const int shift = 8 * (address - (address >= kAccbl ? kAccbl : kAccal));
    const std::uint64_t bits = std::uint64_t{mask} << shift;
    const std::uint64_t merged =
        (static_cast<std::uint64_t>(acc) & ~bits) | (std::uint64_t{value} << shift & bits);
    acc = static_cast<std::int64_t>(merged << 24) >> 24;
}

void write_status(Machine& m, std::uint16_t value, std::uint16_t mask) {
    CoreState& st = m.st;
    std::uint16_t writable = sr::C | sr::Z | sr::OV | sr::N | sr::DC;
    if (!m.irq.nesting_disabled()) writable |= sr::IPL;
    const auto bits = static_cast<std::uint16_t>(writable & mask);
    std::uint32_t s = (st.sr & ~std::uint32_t{bits}) | (value & bits);
    // SA, SB, SAB can only be cleared; clearing SAB clears both.
    const std::uint32_t cleared = mask & ~std::uint32_t{value} & (sr::SA | sr::SB | sr::SAB);
    s &= ~(cleared & (sr::SA | sr::SB));
    if (cleared & sr::SAB) s &= ~std::uint32_t{sr::SA | sr::SB};
    if (!(s & (sr::SA | sr::SB))) s &= ~std::uint32_t{sr::SAB};
    st.sr = static_cast<std::uint16_t>(s);
    reconsider(m, st.cycle);
}

void write_control(Machine& m, std::uint16_t value, std::uint16_t mask) {
    CoreState& st = m.st;
    constexpr std::uint16_t kWritable = corcon::IF | corcon::RND | corcon::PSV | corcon::ACCSAT |
                                        corcon::SATDW | corcon::SATB | corcon::SATA | corcon::US;
    const auto bits = static_cast<std::uint16_t>(kWritable & mask);
    st.corcon = static_cast<std::uint16_t>((st.corcon & ~bits) | (value & bits));
    if (value & mask & corcon::EDT) st.corcon |= corcon::EDT;
    if (mask & ~value & corcon::IPL3) st.corcon &= static_cast<std::uint16_t>(~corcon::IPL3);
    reconsider(m, st.cycle);
}

/// A write while nonzero extends or cuts; a write while 0 has no effect.
void write_disicnt(Machine& m, std::uint16_t value) {
    if (m.st.disi_end <= m.st.cycle) return;
    m.st.disi_end = m.st.cycle + (value & 0x3FFFu);
    reconsider(m, m.st.cycle);
}

void write_register(void* owner, std::uint16_t address, std::uint16_t written, std::uint16_t mask) {
    auto& m = *static_cast<Machine*>(owner);
    CoreState& st = m.st;
    // What the whole register would be after this write, byte lanes merged.
    const auto value = static_cast<std::uint16_t>((read_register(owner, address) & ~mask) | (written & mask));
    const auto put_low = [&](std::uint32_t& a) { a = (a & 0x7F0000) | (value & 0xFFFEu); };
    const auto put_high = [&](std::uint32_t& a) { a = (a & 0xFFFF) | (value & 0x7Fu) << 16; };
    if (address < kSplim) return set_w(m, address >> 1, value);
    switch (address) {
    case kSplim:
        st.splim = value & 0xFFFE;
        st.splim_armed = true;
        update_pointer_rules(m);
        break;
    case kAccal:
    case kAccah:
    case kAccau:
    case kAccbl:
    case kAccbh:
    case kAccbu:
        write_accumulator(st, address, written, mask);
        break;
    case kTblpag:
        st.tblpag = value & 0xFF;
        break;
    case kPsvpag:
        st.psvpag = value & 0xFF;
        break;
    case kRcount:
        st.rcount = value & 0x3FFF;
        break;
    case kDcount:
        st.loop.dcount = value & 0x3FFF;
        break;
    case kDostartl:
    case kDostarth:
        if (m.device.family_33f) break;  // read only there
        address == kDostartl ? put_low(st.loop.dostart) : put_high(st.loop.dostart);
        break;
    case kDoendl:
    case kDoendh:
        address == kDoendl ? put_low(st.loop.doend) : put_high(st.loop.doend);
        mark(m, st.loop.doend, kLoopEnd);
        break;
    case kSr:
        write_status(m, written, mask);
        break;
    case kCorcon:
        write_control(m, written, mask);
        break;
    case kModcon:
        st.modcon = value & 0xCFFF;
        update_pointer_rules(m);
        break;
    case kXmodsrt:
        st.xmodsrt = value & 0xFFFE;
        break;
    case kXmodend:
        st.xmodend = value | 1;
        break;
    case kYmodsrt:
        st.ymodsrt = value & 0xFFFE;
        break;
    case kYmodend:
        st.ymodend = value | 1;
        break;
    case kXbrev:
        st.xbrev = value;
        update_pointer_rules(m);
        break;
    case kDisicnt:
        write_disicnt(m, value);
        break;
    default:  // PCL, PCH are read-only
        break;
    }
}

}  // namespace

void hook_registers(Machine& m) {
    for (std::uint16_t address = 0; address <= kLast; address = static_cast<std::uint16_t>(address + 2))
        m.sfr.hook(address, &m, &read_register, &write_register);
}

/// W15, CORCON and the modulo ends have reset values of their own; what the data sheet calls unknown keeps
/// its old contents (0 at power-on), as does RAM.
void reset_registers(Machine& m) {
    CoreState& st = m.st;
    CoreState fresh;
    fresh.w[15] = kRamStart;
    fresh.corcon = corcon::SATDW;
    fresh.cycle = st.cycle;
    fresh.rcount = st.rcount;
    fresh.loop = st.loop;
    fresh.xmodsrt = st.xmodsrt;
    fresh.xmodend = st.xmodend;
    fresh.ymodsrt = st.ymodsrt;
    fresh.ymodend = st.ymodend;
    fresh.xbrev = st.xbrev & 0x7FFF;
    st = fresh;
    m.watch = 0x7FFF0000;  // nothing but W15 has been written
    update_pointer_rules(m);
}

}  // namespace puckloop::dspic
