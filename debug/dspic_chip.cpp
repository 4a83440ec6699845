// The dsPIC, which GDB does not know: registers by a target description of our own, and addresses as follows.
//   0x000000..0x7FFFFF, 0xF80000..0xFFFFFF  program space in program-counter units (two a word): the low and
//                                           the middle byte of each word, as table reads see them
//   0x800000..0x80FFFF                      data space, by data address
//   0x1000000 + 2 * address                 program space as in Intel HEX: four bytes a word, the last one 0

#include "debug/debug_chip.h"
#include "debug/register_fields.h"
#include "emu/dspic/assembler/disassembler.h"
#include "emu/dspic/chip/chip.h"
#include "emu/dspic/chip/chip_faults.h"
#include "emu/dspic/core/core.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace puckloop::debug {

namespace {

constexpr std::uint32_t kWholeWords = 0x1000000;
constexpr std::uint32_t kProgramSpace = 0x1000000;
constexpr std::uint16_t kWEnd = 0x20;
constexpr std::uint16_t kDmaRam = 0x7800;  ///< of the dsPIC33FJ256GP710, up to the end of its RAM
constexpr std::size_t kDspicPc = 16, kAccA = 17, kAccB = 18, kSpecials = 19;
/// Behind PC and the accumulators; read and written by their data-sheet names.
constexpr std::string_view kSpecialNames[] = {"SR",     "CORCON", "SPLIM",  "RCOUNT", "DCOUNT",
                                              "TBLPAG", "PSVPAG", "MODCON", "XBREV",  "DISICNT"};

std::vector<RegisterInfo> dspic_registers() {
    std::vector<RegisterInfo> registers;
    for (int i = 0; i < 16; ++i)
        registers.push_back({fmt::format("w{}", i), 16, i >= 14 ? "data_ptr" : ""});
    registers.push_back({"pc", 32, "code_ptr"});
    registers.push_back({"acca", 64});  // 40 bits, sign extended
    registers.push_back({"accb", 64});
    for (const std::string_view name : kSpecialNames) {
        std::string lower(name);
        for (char& c : lower)
            c = static_cast<char>(c | 0x20);
        registers.push_back({lower, 16});
    }
    return registers;
}

class DspicDebugChip final : public DebugChip {
  public:
    explicit DspicDebugChip(dspic::Chip& chip) : chip_(chip), faults_(chip), registers_(dspic_registers()) {}

    std::string_view architecture() const override { return {}; }
    std::string_view name() const override { return device().name; }
    std::span<const RegisterInfo> registers() const override { return registers_; }

    void read_registers(std::span<std::uint64_t> values) const override {
        const dspic::CoreState s = core().state();
        for (std::size_t i = 0; i < s.w.size(); ++i)
            values[i] = s.w[i];
        values[kDspicPc] = s.pc;
        values[kAccA] = static_cast<std::uint64_t>(s.acc[0]);
        values[kAccB] = static_cast<std::uint64_t>(s.acc[1]);
        const std::uint64_t disicnt = s.disi_end > s.cycle ? s.disi_end - s.cycle : 0;
        const std::uint64_t specials[] = {s.sr,     s.corcon, s.splim,  s.rcount, s.loop.dcount,
                                          s.tblpag, s.psvpag, s.modcon, s.xbrev,  disicnt};
        static_assert(std::size(specials) == std::size(kSpecialNames));
        std::copy(std::begin(specials), std::end(specials), values.begin() + kSpecials);
    }
    bool write_register(std::size_t number, std::uint64_t value) override {
        if (number < kDspicPc) {
            core().set_w(static_cast<int>(number), static_cast<std::uint16_t>(value));
            return true;
        }
        if (number == kDspicPc) {
            if (!is_code(static_cast<std::uint32_t>(value))) return false;
            core().set_pc(static_cast<std::uint32_t>(value));
            return true;
        }
        if (number < kSpecials) {
            const char* const parts[] = {"L", "H", "U"};
            for (int i = 0; i < 3; ++i)
                put(fmt::format("ACC{}{}", number == kAccB ? 'B' : 'A', parts[i]),
                    static_cast<std::uint16_t>(value >> 16 * i));
            return true;
        }
        return put(std::string(kSpecialNames[number - kSpecials]), static_cast<std::uint16_t>(value));
    }

    bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const override {
        for (std::uint8_t& byte : bytes) {
            const std::optional<std::uint8_t> value = read_byte(address++);
            if (!value) return false;
            byte = *value;
        }
        return true;
    }
    bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) override {
        // Whole registers at once where they are written whole: halves would act twice.
        while (!bytes.empty()) {
            const auto data = data_address(address);
            const bool whole = data && *data % 2 == 0 && bytes.size() >= 2;
            const std::size_t size = whole ? 2 : 1;
            if (!write_cell(address, bytes.first(size))) return false;
            bytes = bytes.subspan(size);
            address += static_cast<std::uint32_t>(size);
        }
        return true;
    }
    std::uint32_t ram_start() const override { return device().ram_start; }
    std::uint32_t ram_end() const override { return device().ram_end; }
    bool shared(std::uint16_t data) const override { return device().family_33f && data >= kDmaRam; }
    bool stack_grows_up() const override { return true; }

    std::uint32_t pc() const override { return chip_.pc(); }
    std::uint16_t stack_pointer() const override { return core().w(15); }
    std::uint64_t cycle() const override { return core().cycle(); }
    std::uint64_t instructions() const override { return core().instructions(); }
    bool repeating() const override { return core().state().sr & dspic::sr::RA; }
    bool asleep() const override { return core().power_mode() != dspic::PowerMode::Run; }
    Instruction instruction(std::uint32_t pc) const override {
        const std::uint32_t word = core().program(pc), next = core().program(pc + 2);
        Instruction found{dspic::disassemble(word, next, pc),
                          2u * static_cast<std::uint32_t>(dspic::length_of(word, next)), Flow::Other};
        const std::uint32_t high = word >> 16;
        const bool by_register = (word & 0xFFDFF0) == 0x010000;  // CALL Wn, RCALL Wn
        constexpr std::uint32_t kReturn = 0x060000, kRetfie = 0x064000;
        if (high == 0x02 || high == 0x07 || by_register) found.flow = Flow::Call;
        if (word == kReturn || high == 0x05) found.flow = Flow::Return;
        if (word == kRetfie) found.flow = Flow::InterruptReturn;
        return found;
    }
    bool is_code(std::uint32_t pc) const override { return pc % 2 == 0 && pc < device().flash_end; }
    std::string vector_name(int vector) const override { return std::string(device().vector_name(vector)); }

    std::optional<Special> special(std::string_view name) const override {
        for (const dspic::RegisterInfo& info : device().registers) {
            if (info.name != name) continue;
            const std::uint32_t value = read_register_at(info.address);
            return Special{value, info.address, 16, fields_of(info.fields, value)};
        }
        return std::nullopt;
    }
    std::vector<std::string> special_names() const override {
        std::vector<std::string> names;
        for (const dspic::RegisterInfo& info : device().registers)
            names.emplace_back(info.name);
        return names;
    }

    void set_stops(std::span<const std::uint32_t> addresses) override {
        chip_.set_stops({addresses.begin(), addresses.end()});
    }
    void set_instrument(chip::Instrument* instrument, bool accesses) override {
        core().set_instrument(instrument, accesses);
    }

  private:
    dspic::Core& core() const { return chip_.inside().core; }
    const dspic::DeviceInfo& device() const { return chip_.inside().device; }
    std::uint16_t read_register_at(std::uint16_t address) const {
        // The core's own registers live in the core, and reading them does nothing.
        constexpr std::uint16_t kCoreEnd = 0x60;
        const dspic::Chip::Inside in = chip_.inside();
        if (address >= kWEnd && address < kCoreEnd && in.sfr.modelled(address)) return in.sfr.read(address);
        return static_cast<std::uint16_t>(faults_.read({chip::MemorySpace::Register, address}));
    }
    bool put(const std::string& name, std::uint16_t value) {
        const auto found = special(name);
        if (found) chip_.inside().sfr.write(static_cast<std::uint16_t>(found->address), value, 0xFFFF);
        return found.has_value();
    }
    /// A word of program space by its place among all words' bytes: low, middle, high, 0.
    std::optional<std::uint8_t> program_byte(std::uint32_t pc, unsigned place) const {
        const dspic::DeviceInfo& d = device();
        const auto within = [pc](std::uint32_t start, std::uint32_t words) {
            return pc >= start && pc - start < 2 * words;
        };
        if (!within(0, d.flash_end / 2) && !within(d.eeprom_start, d.eeprom_words) &&
            !within(d.config_start, d.config_words) && !within(d.unit_id_start, d.unit_id_words) &&
            !within(0xFF0000, 2))
            return std::nullopt;
        return static_cast<std::uint8_t>(core().program(pc & ~1u) >> 8 * place);
    }
    std::optional<std::uint8_t> read_byte(std::uint32_t address) const {
        if (const auto data = data_address(address)) {
            const auto even = static_cast<std::uint16_t>(*data & ~1u);
            std::uint16_t word = 0;
            if (even < kWEnd)
                word = core().w(even / 2);
            else if (even >= device().ram_start && even < device().ram_end)
                word = chip_.peek_data(even);
            else if (even < device().ram_start && chip_.inside().sfr.info(even))
                word = read_register_at(even);
            else if (even >= device().ram_end)
                return std::nullopt;
            return static_cast<std::uint8_t>(*data % 2 ? word >> 8 : word);
        }
        if (address < kProgramSpace) return program_byte(address, address % 2);
        const std::uint32_t offset = address - kWholeWords;
        if (offset >= 2 * kProgramSpace) return std::nullopt;
        return program_byte(offset / 2 & ~1u, offset % 4);
    }
    bool write_cell(std::uint32_t address, std::span<const std::uint8_t> bytes) {
        if (const auto data = data_address(address)) return write_data(*data, bytes);
        const bool whole = address >= kWholeWords;
        const std::uint32_t pc = whole ? (address - kWholeWords) / 2 & ~1u : address & ~1u;
        const unsigned place = whole ? address % 4 : address % 2;
        if (!program_byte(pc, 0)) return false;
        constexpr unsigned kBytes = 3;
        if (place >= kBytes) return true;  // the byte that no word has
        const std::uint32_t word = core().program(pc) & ~(0xFFu << 8 * place);
        return core().poke_program(pc, word | std::uint32_t{bytes[0]} << 8 * place);
    }
    bool write_data(std::uint16_t data, std::span<const std::uint8_t> bytes) {
        const auto even = static_cast<std::uint16_t>(data & ~1u);
        const unsigned shift = data % 2 ? 8 : 0;
        const std::uint32_t value =
            bytes.size() == 2 ? bytes[0] | bytes[1] << 8 : std::uint32_t{bytes[0]} << shift;
        const std::uint32_t mask = bytes.size() == 2 ? 0xFFFF : 0xFFu << shift;
        const auto merged = [&](std::uint16_t old) {
            return static_cast<std::uint16_t>((old & ~mask) | (value & mask));
        };
        if (even < kWEnd) {
            core().set_w(even / 2, merged(core().w(even / 2)));
        } else if (even < device().ram_start) {
            chip_.inside().sfr.write(even, static_cast<std::uint16_t>(value),
                                     static_cast<std::uint16_t>(mask));
        } else if (even < device().ram_end) {
            std::uint16_t& word = core().ram()[(even - device().ram_start) / 2u];
            word = merged(word);
        } else {
            return false;
        }
        return true;
    }

    dspic::Chip& chip_;
    dspic::ChipFaults faults_;
    std::vector<RegisterInfo> registers_;
};

}  // namespace

std::unique_ptr<DebugChip> make_debug_chip(dspic::Chip& chip) {
    return std::make_unique<DspicDebugChip>(chip);
}

}  // namespace puckloop::debug
