// Data space outside RAM, the core's own registers, and program memory as data.

#include "emu/avr/machine/machine.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::avr {

namespace {

constexpr std::uint16_t kRampz = 0x5B, kSpl = 0x5D, kSph = 0x5E, kSreg = 0x5F;
constexpr std::uint16_t kIoStart = 0x20;
constexpr std::uint16_t kGeneralPurposeIo[] = {0x3E, 0x4A, 0x4B};

/// The last clock of the instruction is where it reaches its register; what is due by then happens first.
void begin_access(Machine& m, const Op* op) {
    m.current = op;
    const Cycle access = m.cycle + op->cycles - 1;
    serve_events(m, access);
    m.now = access;
}
void end_access(Machine& m) {
    if (m.events.next() < m.limit) m.limit = m.events.next();
}

std::uint8_t read_core(void* owner, std::uint16_t address) {
    const Machine& m = *static_cast<Machine*>(owner);
    switch (address) {
    case kRampz:
        return m.rampz;
    case kSpl:
        return static_cast<std::uint8_t>(m.sp);
    case kSph:
        return static_cast<std::uint8_t>(m.sp >> 8);
    default:
        return m.sreg;
    }
}

void write_core(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t) {
    Machine& m = *static_cast<Machine*>(owner);
    switch (address) {
    case kRampz:
        m.rampz = value & (m.device.flash_words > 0x8000 ? 1 : 0);
        break;
    case kSpl:
        m.sp = static_cast<std::uint16_t>((m.sp & 0xFF00) | value);
        break;
    case kSph:
        m.sp = static_cast<std::uint16_t>((m.sp & 0x00FF) | value << 8);
        break;
    default:
        write_sreg(m, m.current, value);
        break;
    }
}

}  // namespace

void hook_core_registers(Machine& m) {
    for (const std::uint16_t address : {kRampz, kSpl, kSph, kSreg})
        m.io.hook(address, &m, &read_core, &write_core);
    for (const std::uint16_t address : {kRampz, kSpl, kSph, kSreg})
        m.io.mark_steady(address);
    for (const std::uint16_t address : kGeneralPurposeIo)
        m.io.claim(address);
}

void write_sreg(Machine& m, const Op* op, std::uint8_t value) {
    const bool enables = value & ~m.sreg & sreg::I;
    m.sreg = value;
    if (!enables) return;
    m.hold_at = m.cycle + op->cycles;  // the next instruction comes before any interrupt
    if (m.irq.any()) m.limit = 0;
}

std::uint8_t load_outside_ram(Machine& m, const Op* op, std::uint16_t address) {
    if (shows_accesses(m)) {
        m.instrument->access(address, 1, false);
        if (address - m.ram_start < m.device.ram_bytes) return m.data[address];
    }
    if (address < kIoStart) return m.data[address];
    if (address >= m.ram_start) {
        warn_once(m, op, 0x10000u | address,
                  fmt::format("read of data address 0x{:04X}, past the RAM", address));
        return 0;
    }
    begin_access(m, op);
    const std::uint8_t value = m.io.read(address);
    end_access(m);
    return value;
}

void store_outside_ram(Machine& m, const Op* op, std::uint16_t address, std::uint8_t value,
                       std::uint8_t mask) {
    if (shows_accesses(m)) m.instrument->access(address, 1, true);
    if (address < m.ram_start && address == static_cast<std::uint16_t>(m.sp + 1)) {
        constexpr std::uint32_t kStackBelow = 0x30002;  // key of the warning
        warn_once(m, op, kStackBelow, "the stack has grown below the RAM, into registers");
    }
    if (address < kIoStart || address - m.ram_start < m.device.ram_bytes) {
        m.data[address] = value;
    } else if (address >= m.ram_start) {
        warn_once(m, op, 0x20000u | address,
                  fmt::format("write to data address 0x{:04X}, past the RAM", address));
    } else {
        begin_access(m, op);
        m.io.write(address, value, mask);
        end_access(m);
    }
}

std::uint8_t load_program(Machine& m, const Op* op, std::uint32_t address) {
    m.current = op;
    std::uint8_t value = 0;
    if (m.hooks.load_program && m.hooks.load_program(address, value)) return value;
    const std::uint16_t word = m.program[(address >> 1) & (m.device.flash_words - 1)];
    return static_cast<std::uint8_t>(address & 1 ? word >> 8 : word);
}

bool was_warned(const Machine& m, std::uint32_t key) {
    return std::find(m.warned.begin(), m.warned.end(), key) != m.warned.end();
}

void warn_once(Machine& m, const Op* op, std::uint32_t key, std::string_view text) {
    if (was_warned(m, key)) return;
    m.warned.push_back(key);
    if (m.observer.on_warning) m.observer.on_warning(text, m.pc_of(op));
}

}  // namespace puckloop::avr
