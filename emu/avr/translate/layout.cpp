#include "emu/avr/translate/layout.h"

#include "emu/avr/machine/alu.h"

namespace puckloop::avr::translate {

namespace {

// The host's flags as LAHF leaves them in AH.
constexpr unsigned kHostCarry = 1u << 0, kHostHalf = 1u << 4, kHostZero = 1u << 6, kHostSign = 1u << 7;

std::uint8_t flags_of(unsigned host, bool overflow) {
    const bool negative = host & kHostSign;
    return static_cast<std::uint8_t>((host & kHostCarry ? sreg::C : 0) | (host & kHostZero ? sreg::Z : 0) |
                                     (negative ? sreg::N : 0) | (overflow ? sreg::V : 0) |
                                     (negative != overflow ? sreg::S : 0) | (host & kHostHalf ? sreg::H : 0));
}

}  // namespace

Layout::Layout(const Machine& m) {
    const auto offset = [&m](const auto& field) {
        return static_cast<int>(reinterpret_cast<const char*>(&field) - reinterpret_cast<const char*>(&m));
    };
    data = offset(m.data);
    sreg = offset(m.sreg);
    sp = offset(m.sp);
    cycle = offset(m.cycle);
    limit = offset(m.limit);
    instructions = offset(m.instructions);
    code = offset(m.code);
    current = offset(m.current);
    now = offset(m.now);
    skip_idle = offset(m.skip_idle);
    loops = offset(m.loop_info);
    entries = offset(m.translated.entries);
    ram_start = m.ram_start;
    ram_bytes = m.ram_bytes;
    flash_words = m.device.flash_words;
    for (unsigned host = 0; host < 256; ++host) {
        tables.flags[host] = flags_of(host, false);
        tables.flags[256 + host] = flags_of(host, true);
        const bool negative = host & kHostSign, carry = host & kHostCarry;
        tables.shift_flags[host] = flags_of(host, negative != carry);
        const bool ram = host * 256 >= ram_start && host * 256 < ram_start + ram_bytes;
        tables.not_ram[host] = ram ? 0 : 1;
    }
}

}  // namespace puckloop::avr::translate
