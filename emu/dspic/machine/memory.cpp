// Data and program memory beyond the fast RAM path: registers, the PSV window, what is not there, and the
// address arithmetic of modulo and bit-reversed pointers.

#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/machine/machine.h"

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kMODCON{"MODCON"};
constexpr RegisterBits kXBREV{"XBREV"};

std::uint16_t read_sfr(Machine& m, std::uint16_t address) {
    const std::uint16_t value = m.sfr.read(address);
    m.bound_limit();
    return value;
}

/// A read through the window, with the cycles it costs the instruction, both words of MOV.D together, outside
/// and inside REPEAT.
std::uint16_t read_psv(Machine& m, std::uint16_t address) {
    bool implemented = false;
    const std::uint32_t window = std::uint32_t{m.st.psvpag} << 15 | (address & 0x7FFEu);
    const std::uint32_t word = read_program(m, window, &implemented);
    if (!implemented) raise_trap(m, Trap::AddressError);
    constexpr unsigned kRepeatEdge = 2;
    if (m.st.sr & sr::RA)
        m.late = m.repeat_edge ? kRepeatEdge : 0;
    else
        m.late = m.current->psv_extra;
    if (m.late != 0) m.limit = 0;  // the run loop adds them
    return static_cast<std::uint16_t>(word);
}

std::uint16_t read_aligned(Machine& m, std::uint16_t address) {
    if (address < kWEnd) return m.st.w[address >> 1];
    if (address < kRamStart) return read_sfr(m, address);
    const auto index = static_cast<std::uint16_t>((address - kRamStart) >> 1);
    if (index < m.ram_store.size()) return m.ram[index];
    if (address >= kPsvStart && m.st.corcon & corcon::PSV) return read_psv(m, address);
    raise_trap(m, Trap::AddressError);
    return 0;
}

void write_masked(Machine& m, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    if (address < kWEnd) {
        const int reg = address >> 1;
        set_w(m, reg, (get_w(m, reg) & ~std::uint32_t{mask}) | (value & mask));
        m.watch = (m.watch | 1u << reg) & ~(0x10000u << reg);
    } else if (address < kRamStart) {
        m.sfr.write(address, value, mask);
        m.bound_limit();
    } else if (const std::uint32_t index = (address - kRamStart) / 2u; index < m.ram_store.size()) {
        m.ram[index] = static_cast<std::uint16_t>((m.ram[index] & ~mask) | (value & mask));
    } else {
        raise_trap(m, Trap::AddressError);
    }
}

/// Every access takes the slow path while an instrument wants to see it.
void show(const Machine& m, std::uint16_t address, int bytes, bool write) {
    if (m.ram_words == 0) m.instrument->access(address, bytes, write);
}

/// Buffer bounds of the X or Y unit.
std::uint16_t wrap(std::uint16_t address, int step, std::uint16_t start, std::uint16_t end) {
    const int length = end + 1 - start;
    int moved = address + step;
    if (step > 0 && moved > end) moved -= length;
    if (step < 0 && moved < start) moved += length;
    return static_cast<std::uint16_t>(moved);
}

std::uint16_t reverse_carry_add(std::uint16_t address, std::uint16_t xb) {
    // Bits 15:1 count with the carry running downwards.
    const auto mirror = [](std::uint32_t v) {
        std::uint32_t r = 0;
        for (int i = 0; i < 15; ++i)
            r |= (v >> i & 1) << (14 - i);
        return r;
    };
    const std::uint32_t sum = (mirror(address >> 1) + mirror(xb)) & 0x7FFF;
    return static_cast<std::uint16_t>(mirror(sum) << 1);
}

int xwm(const Machine& m) {
    return static_cast<int>(kMODCON["XWM"].of(m.st.modcon));
}
int ywm(const Machine& m) {
    return static_cast<int>(kMODCON["YWM"].of(m.st.modcon));
}
int bwm(const Machine& m) {
    return static_cast<int>(kMODCON["BWM"].of(m.st.modcon));
}
bool bit_reversed(const Machine& m) {
    return m.st.xbrev & kXBREV["BREN"] && bwm(m) != 15;
}
bool x_modulo(const Machine& m, int reg, bool write) {
    return m.st.modcon & kMODCON["XMODEN"] && xwm(m) == reg && reg != 15 && !(write && bit_reversed(m));
}

}  // namespace

std::uint16_t read16_slow(Machine& m, std::uint16_t address) {
    show(m, address, 2, false);
    if (address & 1) {
        // The read completes with undefined data (here: the aligned word of RAM or W, else 0).
        raise_trap(m, Trap::AddressError);
        if (address >= kWEnd && address < kRamStart) return 0;
        if (address >= m.device.ram_end) return 0;
    }
    return read_aligned(m, address & 0xFFFE);
}
std::uint16_t read8_slow(Machine& m, std::uint16_t address) {
    show(m, address, 1, false);
    const std::uint16_t word = read_aligned(m, address & 0xFFFE);
    return address & 1 ? word >> 8 : word & 0xFF;
}
void write16_slow(Machine& m, std::uint16_t address, std::uint16_t value) {
    show(m, address, 2, true);
    if (address & 1) return raise_trap(m, Trap::AddressError);  // the write is suppressed
    write_masked(m, address, value, 0xFFFF);
}
void write8_slow(Machine& m, std::uint16_t address, std::uint16_t value) {
    show(m, address, 1, true);
    const bool high = address & 1;
    write_masked(m, address & 0xFFFE, static_cast<std::uint16_t>(high ? value << 8 : value & 0xFF),
                 high ? 0xFF00 : 0x00FF);
}

std::uint16_t special_ea(Machine& m, int reg, int pre, int post, bool write, bool word) {
    const std::uint16_t old = get_w(m, reg);
    const bool increments = pre > 0 || post > 0;
    if (write && word && increments && bit_reversed(m) && bwm(m) == reg) {
        const std::uint16_t next = reverse_carry_add(old, m.st.xbrev & kXBREV["XB"]);
        set_w(m, reg, next);
        return pre ? next : old;
    }
    const auto moved = [&](std::uint16_t from, int step) {
        if (!x_modulo(m, reg, write)) return static_cast<std::uint16_t>(from + step);
        return wrap(from, step, m.st.xmodsrt, m.st.xmodend);
    };
    const std::uint16_t address = moved(old, pre);
    set_w(m, reg, moved(address, post));
    return address;
}

std::uint16_t special_offset(Machine& m, int reg, std::uint16_t offset, bool write) {
    const std::uint16_t base = get_w(m, reg);
    if (reg == 15) {
        const auto address = static_cast<std::uint16_t>(base + offset);
        check_stack(m, address);
        return address;
    }
    if (!x_modulo(m, reg, write)) return static_cast<std::uint16_t>(base + offset);
    return wrap(base, static_cast<std::int16_t>(offset), m.st.xmodsrt, m.st.xmodend);
}

std::uint16_t modulo_y(Machine& m, int reg, int step) {
    const std::uint16_t old = get_w(m, reg);
    if (!(m.st.modcon & kMODCON["YMODEN"]) || ywm(m) != reg) return static_cast<std::uint16_t>(old + step);
    return wrap(old, step, m.st.ymodsrt, m.st.ymodend);
}

void update_pointer_rules(Machine& m) {
    forget_loops(m);
    std::uint32_t special = 1u << 15;
    if (m.st.modcon & kMODCON["XMODEN"]) special |= 1u << xwm(m);
    if (bit_reversed(m)) special |= 1u << bwm(m);
    m.special = static_cast<std::uint16_t>(special);
    m.stack_span = (m.st.splim_armed ? m.st.splim : 0xFFFF) - kRamStart;
}

std::uint32_t read_program(const Machine& m, std::uint32_t address, bool* implemented) {
    const auto from = [&](std::uint32_t start, const auto& words) -> std::optional<std::uint32_t> {
        const std::uint32_t index = (address - start) >> 1;
        if (address < start || index >= words.size()) return std::nullopt;
        return words[index];
    };
    constexpr std::uint32_t kDevid = 0xFF0000;
    const DeviceInfo& d = m.device;
    std::optional<std::uint32_t> word;
    if (address < d.flash_end)
        word = m.program[address >> 1];
    else if (auto e = from(d.eeprom_start, m.eeprom))
        word = e;
    else if (auto c = from(d.config_start, m.config))
        word = c;
    else if (auto u = from(d.unit_id_start, m.unit_id))
        word = u;
    else if ((address & ~1u) == kDevid)
        word = d.devid;
    else if ((address & ~1u) == kDevid + 2)
        word = d.devrev;
    if (implemented) *implemented = word.has_value();
    return word.value_or(0);
}

bool store_program(Machine& m, std::uint32_t address, std::uint32_t word) {
    const DeviceInfo& d = m.device;
    const auto into = [&](std::uint32_t start, auto& words) {
        const std::uint32_t index = (address - start) >> 1;
        if (address < start || index >= words.size()) return false;
        words[index] = static_cast<typename std::remove_reference_t<decltype(words)>::value_type>(word);
        return true;
    };
    if (address < d.flash_end) {
        m.program[address >> 1] = word;
        return true;
    }
    return into(d.eeprom_start, m.eeprom) || into(d.config_start, m.config) ||
           into(d.unit_id_start, m.unit_id);
}

bool write_program(Machine& m, std::uint32_t address, std::uint32_t word) {
    if (m.program_undo.on()) m.program_undo.note_word(address, read_program(m, address));
    if (!store_program(m, address, word & 0xFFFFFF)) return false;
    if (address < m.device.flash_end) invalidate(m, address);
    return true;
}

void warn_once(Machine& m, std::uint32_t key, std::string_view text) {
    if (std::find(m.warned.begin(), m.warned.end(), key) != m.warned.end()) return;
    m.warned.push_back(key);
    if (m.observer.on_warning) m.observer.on_warning(text, m.pc_of(m.current));
}

}  // namespace puckloop::dspic
