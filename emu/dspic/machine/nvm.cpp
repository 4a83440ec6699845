// Self-programming: flash rows, EEPROM words and rows, configuration words.
// Source: family reference manual, "Flash and EEPROM programming" (DS70052); fact sheet semantics section 15.
// Deviations:
//   1. every operation takes the 30F's typical 2 ms, but for a 33FJ's row; contents change at its start.
//   2. the key sequence must precede WR, but not in the very instruction before it.
//   3. write protection by configuration words is not enforced.

#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/machine/machine.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kNVMCON{"NVMCON"};

constexpr double kDuration = 2e-3;             ///< seconds, typical
constexpr double kRow33F = 11064 / 7.37e6;     ///< seconds: so many cycles of the RC oscillator (DS70286)
constexpr Cycle kDurationUnknownRate = 29491;  ///< 2 ms at the e-puck's 14.7456 MHz
constexpr std::uint32_t kEepromRow = 16;

bool in_eeprom(const Machine& m, std::uint32_t address) {
    return address >= m.device.eeprom_start && address < m.device.eeprom_start + 2 * m.device.eeprom_words;
}

bool in_configuration(const Machine& m, std::uint32_t address) {
    return address >= m.device.config_start && address < m.device.config_start + 2 * m.device.config_words;
}

void erase(Machine& m, std::uint32_t address, std::uint32_t words) {
    const std::uint32_t start = address & ~(2 * words - 1);
    for (std::uint32_t i = 0; i < words; ++i)
        write_program(m, start + 2 * i, kErasedWord);
}

/// Programming only clears bits.
void program(Machine& m, std::uint32_t address, std::uint32_t words) {
    const std::uint32_t start = address & ~(2 * words - 1);
    for (std::uint32_t i = 0; i < words; ++i) {
        const std::uint32_t at = start + 2 * i;
        const std::uint32_t latch = m.nvm.latch[(at >> 1) % m.nvm.latch.size()];
        write_program(m, at, read_program(m, at) & latch);
    }
    std::fill(m.nvm.latch.begin(), m.nvm.latch.end(), kErasedWord);
}

bool start_30f(Machine& m, std::uint16_t code) {
    const std::uint32_t address = m.nvm.address;
    const bool eeprom = in_eeprom(m, address);
    switch (code) {
    case 0x41:
        if (address >= m.device.flash_end) return false;
        erase(m, address, m.device.erase_words);
        return true;
    case 0x01:
        if (address >= m.device.flash_end) return false;
        program(m, address, m.device.row_words);
        return true;
    case 0x44:
        if (eeprom) erase(m, address, 1);
        return eeprom;
    case 0x45:
        if (eeprom) erase(m, address, kEepromRow);
        return eeprom;
    case 0x46:
        erase(m, m.device.eeprom_start, m.device.eeprom_words);
        return true;
    case 0x04:
        if (eeprom) program(m, address, 1);
        return eeprom;
    case 0x05:
        if (eeprom) program(m, address, kEepromRow);
        return eeprom;
    case 0x06:
    case 0x08:  // configuration words are written, not ANDed
        return in_configuration(m, address) &&
               write_program(m, address & ~1u, m.nvm.latch[(address >> 1) % m.nvm.latch.size()]);
    default:
        return false;
    }
}

bool start_33f(Machine& m, std::uint16_t code) {
    const std::uint32_t address = m.nvm.address;
    const bool flash = address < m.device.flash_end;
    switch (code) {
    case 0x42:
        if (flash) erase(m, address, m.device.erase_words);
        return flash;
    case 0x01:
        if (flash) program(m, address, m.device.row_words);
        return flash;
    case 0x03:
        if (flash) program(m, address, 1);
        return flash;
    case 0x40:
        return in_configuration(m, address) && write_program(m, address & ~1u, kErasedWord);
    case 0x00:
        return in_configuration(m, address) &&
               write_program(m, address & ~1u, m.nvm.latch[(address >> 1) % m.nvm.latch.size()]);
    default:
        return false;
    }
}

void finished(void* owner, Cycle due) {
    auto& m = *static_cast<Machine*>(owner);
    m.sfr.raw(sfr::NVMCON) &= static_cast<std::uint16_t>(~kNVMCON["WR"]);
    if (const auto irq = m.device.irq("NVM")) m.irq.raise(*irq, due);
}

void start(Machine& m) {
    std::uint16_t& con = m.sfr.raw(sfr::NVMCON);
    const auto code = static_cast<std::uint16_t>(con & 0x7F);
    const bool background = in_eeprom(m, m.nvm.address) || code == 0x46;
    const bool done = m.device.family_33f ? start_33f(m, code) : start_30f(m, code);
    if (!done) {
        con = static_cast<std::uint16_t>((con & ~kNVMCON["WR"]) | kNVMCON["WRERR"]);
        return;
    }
    con = static_cast<std::uint16_t>((con | kNVMCON["WR"]) & ~kNVMCON["WRERR"]);
    constexpr std::uint16_t kRow = 0x01;
    const double seconds = m.device.family_33f && code == kRow ? kRow33F : kDuration;
    const Cycle length = m.cycle_rate > 0 ? static_cast<Cycle>(seconds * m.cycle_rate) : kDurationUnknownRate;
    m.events.schedule(m.nvm.slot, m.st.cycle + length);
    if (!background) m.stall_end = m.st.cycle + length;
    m.limit = 0;
}

std::uint16_t read_nvm_register(void* owner, std::uint16_t address) {
    const auto& m = *static_cast<const Machine*>(owner);
    if (address == sfr::NVMADR) return static_cast<std::uint16_t>(m.nvm.address);
    if (address == sfr::NVMADRU) return static_cast<std::uint16_t>(m.nvm.address >> 16 & 0xFF);
    return 0;  // NVMKEY is write-only
}

void write_nvm_register(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    auto& m = *static_cast<Machine*>(owner);
    const auto merged = [&](std::uint32_t old) {
        return (old & ~std::uint32_t{mask} & 0xFFFF) | (value & mask);
    };
    switch (address) {
    case sfr::NVMADR:
        m.nvm.address = (m.nvm.address & 0xFF0000) | merged(m.nvm.address);
        break;
    case sfr::NVMADRU:
        m.nvm.address = (m.nvm.address & 0xFFFF) | (merged(m.nvm.address >> 16) & 0xFF) << 16;
        break;
    case sfr::NVMKEY:
        if (!(mask & 0xFF)) break;
        m.nvm.key_step = (value & 0xFF) == 0x55 ? 1 : (value & 0xFF) == 0xAA && m.nvm.key_step == 1 ? 2 : 0;
        break;
    case sfr::NVMCON: {
        std::uint16_t& con = m.sfr.raw(sfr::NVMCON);
        if (con & kNVMCON["WR"]) break;  // busy
        const std::uint32_t next = merged(con) & 0xE17F;
        const bool go = next & kNVMCON["WR"] && next & kNVMCON["WREN"] && m.nvm.key_step == 2;
        con = static_cast<std::uint16_t>(next & ~std::uint32_t{kNVMCON["WR"]});
        if (next & kNVMCON["WR"] && !go)
            warn_once(m, sfr::NVMCON,
                      m.nvm.key_step == 2 ? "set NVMCON<WR> without WREN: nothing is written"
                                          : "set NVMCON<WR> without the unlock sequence: nothing is written");
        if (next & kNVMCON["WR"]) m.nvm.key_step = 0;
        if (go) start(m);
        break;
    }
    default:
        break;
    }
}

}  // namespace

void hook_nvm(Machine& m) {
    m.sfr.hook(sfr::NVMCON, &m, nullptr, &write_nvm_register);
    m.sfr.hook(sfr::NVMKEY, &m, &read_nvm_register, &write_nvm_register);
    if (!m.device.family_33f) {
        m.sfr.hook(sfr::NVMADR, &m, &read_nvm_register, &write_nvm_register);
        m.sfr.hook(sfr::NVMADRU, &m, &read_nvm_register, &write_nvm_register);
    }
    m.nvm.slot = m.events.add(&m, &finished);
    m.nvm.latch.assign(m.device.row_words, kErasedWord);
}

void reset_nvm(Machine& m, ResetCause cause, std::uint16_t nvmcon_before) {
    m.events.cancel(m.nvm.slot);
    // The 33FJ's stays as the operation left it (DS70286, table 4-34): cut off, it failed.
    const bool keeps = m.device.family_33f && cause != ResetCause::PowerOn;
    std::uint16_t con = keeps ? nvmcon_before : std::uint16_t{0};
    if (con & kNVMCON["WR"]) con = static_cast<std::uint16_t>((con & ~kNVMCON["WR"]) | kNVMCON["WRERR"]);
    m.sfr.raw(sfr::NVMCON) = con;
    m.nvm.key_step = 0;
    std::fill(m.nvm.latch.begin(), m.nvm.latch.end(), kErasedWord);
}

void table_write(Machine& m, std::uint32_t address, bool high, bool byte, std::uint16_t value) {
    m.nvm.address = address & 0xFFFFFE;
    std::uint32_t& latch = m.nvm.latch[(address >> 1) % m.nvm.latch.size()];
    const int shift = (high ? 16 : 0) + (byte && address & 1 ? 8 : 0);
    const std::uint32_t field = (byte || high ? 0xFFu : 0xFFFFu) << shift & kErasedWord;
    latch = (latch & ~field) | (std::uint32_t{value} << shift & field);
}

}  // namespace puckloop::dspic
