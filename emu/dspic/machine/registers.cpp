// The core's own registers in the SFR space, 0x0000 to 0x0053.

#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/machine/machine.h"

namespace puckloop::dspic {

namespace {

// The names that instructions use are the tables' too.
constexpr RegisterBits kSR{"SR"}, kCORCON{"CORCON"}, kRCON{"RCON"};
#define SAME(NAMESPACE, TABLE, NAME) static_assert(NAMESPACE::NAME == TABLE[#NAME])
SAME(sr, kSR, C);
SAME(sr, kSR, Z);
SAME(sr, kSR, OV);
SAME(sr, kSR, N);
SAME(sr, kSR, RA);
SAME(sr, kSR, IPL);
SAME(sr, kSR, DC);
SAME(sr, kSR, DA);
SAME(sr, kSR, SAB);
SAME(sr, kSR, OAB);
SAME(sr, kSR, SB);
SAME(sr, kSR, SA);
SAME(sr, kSR, OB);
SAME(sr, kSR, OA);
SAME(corcon, kCORCON, IF);
SAME(corcon, kCORCON, RND);
SAME(corcon, kCORCON, PSV);
SAME(corcon, kCORCON, IPL3);
SAME(corcon, kCORCON, ACCSAT);
SAME(corcon, kCORCON, SATDW);
SAME(corcon, kCORCON, SATB);
SAME(corcon, kCORCON, SATA);
SAME(corcon, kCORCON, DL);
SAME(corcon, kCORCON, EDT);
SAME(corcon, kCORCON, US);
SAME(rcon, kRCON, POR);
SAME(rcon, kRCON, BOR);
SAME(rcon, kRCON, IDLE);
SAME(rcon, kRCON, SLEEP);
SAME(rcon, kRCON, WDTO);
SAME(rcon, kRCON, SWDTEN);
SAME(rcon, kRCON, SWR);
SAME(rcon, kRCON, EXTR);
SAME(rcon, kRCON, IOPUWR);
SAME(rcon, kRCON, TRAPR);
#undef SAME

std::uint16_t accumulator_part(const CoreState& st, std::uint16_t address) {
    const std::int64_t acc = st.acc[address >= sfr::ACCBL];
    const int part = (address - (address >= sfr::ACCBL ? sfr::ACCBL : sfr::ACCAL)) / 2;
    return static_cast<std::uint16_t>(acc >> (16 * part));  // the upper byte reads sign extended
}

std::uint16_t read_register(void* owner, std::uint16_t address) {
    const auto& m = *static_cast<const Machine*>(owner);
    const CoreState& st = m.st;
    const auto low = [](std::uint32_t a) { return static_cast<std::uint16_t>(a); };
    const auto high = [](std::uint32_t a) { return static_cast<std::uint16_t>(a >> 16); };
    if (address < sfr::SPLIM) return st.w[address >> 1];
    switch (address) {
    case sfr::SPLIM:
        return st.splim;
    case sfr::ACCAL:
    case sfr::ACCAH:
    case sfr::ACCAU:
    case sfr::ACCBL:
    case sfr::ACCBH:
    case sfr::ACCBU:
        return accumulator_part(st, address);
    case sfr::PCL:
        return low(m.pc_of(m.current));
    case sfr::PCH:
        return high(m.pc_of(m.current));
    case sfr::TBLPAG:
        return st.tblpag;
    case sfr::PSVPAG:
        return st.psvpag;
    case sfr::RCOUNT:
        return st.rcount;
    case sfr::DCOUNT:
        return st.loop.dcount;
    case sfr::DOSTARTL:
        return low(st.loop.dostart);
    case sfr::DOSTARTH:
        return high(st.loop.dostart);
    case sfr::DOENDL:
        return low(st.loop.doend);
    case sfr::DOENDH:
        return high(st.loop.doend);
    case sfr::SR:
        return st.sr;
    case sfr::CORCON:
        return st.corcon & ~corcon::EDT;
    case sfr::MODCON:
        return st.modcon;
    case sfr::XMODSRT:
        return st.xmodsrt;
    case sfr::XMODEND:
        return st.xmodend;
    case sfr::YMODSRT:
        return st.ymodsrt;
    case sfr::YMODEND:
        return st.ymodend;
    case sfr::XBREV:
        return st.xbrev;
    case sfr::DISICNT:
        return static_cast<std::uint16_t>(st.disi_end > st.cycle ? (st.disi_end - st.cycle) / m.doze.ratio
                                                                 : 0);
    default:
        return 0;
    }
}

void write_accumulator(CoreState& st, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    std::int64_t& acc = st.acc[address >= sfr::ACCBL];
    const int shift = 8 * (address - (address >= sfr::ACCBL ? sfr::ACCBL : sfr::ACCAL));
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
    m.st.disi_end = m.st.cycle + (value & 0x3FFFu) * m.doze.ratio;
    reconsider(m, m.st.cycle);
}

void write_register(void* owner, std::uint16_t address, std::uint16_t written, std::uint16_t mask) {
    auto& m = *static_cast<Machine*>(owner);
    CoreState& st = m.st;
    // What the whole register would be after this write, byte lanes merged.
    const auto value = static_cast<std::uint16_t>((read_register(owner, address) & ~mask) | (written & mask));
    const auto put_low = [&](std::uint32_t& a) { a = (a & 0x7F0000) | (value & 0xFFFEu); };
    const auto put_high = [&](std::uint32_t& a) { a = (a & 0xFFFF) | (value & 0x7Fu) << 16; };
    if (address < sfr::SPLIM) return set_w(m, address >> 1, value);
    switch (address) {
    case sfr::SPLIM:
        st.splim = value & 0xFFFE;
        st.splim_armed = true;
        update_pointer_rules(m);
        break;
    case sfr::ACCAL:
    case sfr::ACCAH:
    case sfr::ACCAU:
    case sfr::ACCBL:
    case sfr::ACCBH:
    case sfr::ACCBU:
        write_accumulator(st, address, written, mask);
        break;
    case sfr::TBLPAG:
        st.tblpag = value & 0xFF;
        break;
    case sfr::PSVPAG:
        st.psvpag = value & 0xFF;
        break;
    case sfr::RCOUNT:
        st.rcount = value & 0x3FFF;
        break;
    case sfr::DCOUNT:
        st.loop.dcount = value & 0x3FFF;
        break;
    case sfr::DOSTARTL:
    case sfr::DOSTARTH:
        if (m.device.family_33f) break;  // read only there
        address == sfr::DOSTARTL ? put_low(st.loop.dostart) : put_high(st.loop.dostart);
        break;
    case sfr::DOENDL:
    case sfr::DOENDH:
        address == sfr::DOENDL ? put_low(st.loop.doend) : put_high(st.loop.doend);
        mark(m, st.loop.doend, kLoopEnd);
        break;
    case sfr::SR:
        write_status(m, written, mask);
        break;
    case sfr::CORCON:
        write_control(m, written, mask);
        break;
    case sfr::MODCON:
        st.modcon = value & 0xCFFF;
        update_pointer_rules(m);
        break;
    case sfr::XMODSRT:
        st.xmodsrt = value & 0xFFFE;
        break;
    case sfr::XMODEND:
        st.xmodend = value | 1;
        break;
    case sfr::YMODSRT:
        st.ymodsrt = value & 0xFFFE;
        break;
    case sfr::YMODEND:
        st.ymodend = value | 1;
        break;
    case sfr::XBREV:
        st.xbrev = value;
        update_pointer_rules(m);
        break;
    case sfr::DISICNT:
        write_disicnt(m, value);
        break;
    default:  // PCL, PCH are read-only
        break;
    }
}

}  // namespace

void hook_registers(Machine& m) {
    for (std::uint16_t address = 0; address <= sfr::DISICNT;
         address = static_cast<std::uint16_t>(address + 2))
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
