// The AVR as avr-gdb knows it: R0 to R31, SREG, SP and PC (in bytes); flash at 0, data space at 0x800000,
// EEPROM at 0x810000, fuses at 0x820000, signature at 0x840000 (avr-libc's convention).

#include "debug/debug_chip.h"
#include "debug/register_fields.h"
#include "emu/avr/assembler/disassembler.h"
#include "emu/avr/chip/chip.h"
#include "emu/avr/chip/chip_faults.h"

#include <fmt/format.h>

#include <array>

namespace puckloop::debug {

namespace {

constexpr std::uint32_t kEeprom = 0x810000, kFuses = 0x820000, kSignature = 0x840000;
constexpr std::uint16_t kWorking = 0x20;  ///< R0 to R31 lie below
constexpr std::size_t kSreg = 32, kSp = 33, kPc = 34;
constexpr std::uint16_t kRcallNext = 0xD000;  ///< a compiler's way to make room on the stack

std::vector<RegisterInfo> avr_registers() {
    std::vector<RegisterInfo> registers;
    for (int i = 0; i < kWorking; ++i)
        registers.push_back({fmt::format("r{}", i), 8});
    registers.push_back({"SREG", 8});
    registers.push_back({"SP", 16, "data_ptr"});
    registers.push_back({"PC", 32, "code_ptr"});
    return registers;
}

class AvrDebugChip final : public DebugChip {
  public:
    explicit AvrDebugChip(avr::Chip& chip) : chip_(chip), faults_(chip), registers_(avr_registers()) {}

    std::string_view architecture() const override { return "avr:51"; }
    std::string_view name() const override { return chip_.inside().device.name; }
    std::span<const RegisterInfo> registers() const override { return registers_; }

    void read_registers(std::span<std::uint64_t> values) const override {
        const avr::CoreState state = core().state();
        for (std::size_t i = 0; i < state.r.size(); ++i)
            values[i] = state.r[i];
        values[kSreg] = state.sreg;
        values[kSp] = state.sp;
        values[kPc] = state.pc * 2u;
    }
    bool write_register(std::size_t number, std::uint64_t value) override {
        avr::CoreState state = core().state();
        if (number < kSreg) state.r[number] = static_cast<std::uint8_t>(value);
        if (number == kSreg) state.sreg = static_cast<std::uint8_t>(value);
        if (number == kSp) state.sp = static_cast<std::uint16_t>(value);
        if (number == kPc) {
            if (!is_code(static_cast<std::uint32_t>(value))) return false;
            state.pc = static_cast<std::uint16_t>(value / 2);
        }
        core().set_state(state);
        return true;
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
        for (const std::uint8_t byte : bytes)
            if (!write_byte(address++, byte)) return false;
        return true;
    }
    std::uint32_t ram_start() const override { return chip_.inside().device.ram_start; }
    std::uint32_t ram_end() const override { return chip_.inside().device.ram_end(); }
    bool stack_grows_up() const override { return false; }

    std::uint32_t pc() const override { return chip_.pc(); }
    std::uint16_t stack_pointer() const override { return core().state().sp; }
    std::uint64_t cycle() const override { return core().cycle(); }
    std::uint64_t instructions() const override { return core().instructions(); }
    bool asleep() const override { return chip_.sleeping(); }
    Instruction instruction(std::uint32_t pc) const override {
        const std::uint16_t word = core().program(pc / 2), next = core().program(pc / 2 + 1);
        const avr::Disassembled text = avr::disassemble(word, next, true, pc);
        Instruction found{text.text, 2u * static_cast<std::uint32_t>(text.words), Flow::Other};
        constexpr std::uint16_t kRet = 0x9508, kReti = 0x9518, kIcall = 0x9509;
        const bool rcall = (word & 0xF000) == 0xD000 && word != kRcallNext;
        if (rcall || word == kIcall || (word & 0xFE0E) == 0x940E) found.flow = Flow::Call;
        if (word == kRet) found.flow = Flow::Return;
        if (word == kReti) found.flow = Flow::InterruptReturn;
        return found;
    }
    bool is_code(std::uint32_t pc) const override {
        return pc % 2 == 0 && pc < chip_.inside().device.flash_bytes();
    }
    std::string vector_name(int vector) const override {
        return std::string(chip_.inside().device.vector_name(vector));
    }

    std::optional<Special> special(std::string_view name) const override {
        const auto place = faults_.find_register(name);
        if (!place) return pair(std::string(name));
        Special found{faults_.read(*place), place->address, 8, {}};
        for (const avr::RegisterInfo& info : chip_.inside().device.registers)
            if (info.name == name) found.fields = fields_of(info.fields, found.value);
        return found;
    }
    std::vector<std::string> special_names() const override {
        std::vector<std::string> names;
        for (const avr::RegisterInfo& info : chip_.inside().device.registers)
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
    avr::Core& core() const { return chip_.inside().core; }
    /// "TCNT1" is TCNT1H and TCNT1L.
    std::optional<Special> pair(const std::string& name) const {
        const auto low = faults_.find_register(name + "L"), high = faults_.find_register(name + "H");
        if (!low || !high) return std::nullopt;
        return Special{faults_.read(*high) << 8 | faults_.read(*low), low->address, 16, {}};
    }
    std::optional<std::uint8_t> read_byte(std::uint32_t address) const {
        const avr::Chip::Inside in = chip_.inside();
        if (address < in.device.flash_bytes()) {
            const std::uint16_t word = in.core.program(address / 2);
            return static_cast<std::uint8_t>(address % 2 ? word >> 8 : word);
        }
        if (const auto data = data_address(address)) {
            if (*data < kWorking) return in.core.state().r[*data];
            if (*data < in.device.ram_start) return chip_.look(*data);
            if (*data < in.device.ram_end()) return in.core.ram()[*data - in.device.ram_start];
            return std::nullopt;
        }
        if (address >= kEeprom && address - kEeprom < in.device.eeprom_bytes)
            return chip_.eeprom()[address - kEeprom];
        const avr::Fuses& fuses = chip_.fuses();
        const std::array<std::uint8_t, 3> bytes{fuses.low, fuses.high, fuses.extended};
        if (address >= kFuses && address - kFuses < bytes.size()) return bytes[address - kFuses];
        if (address >= kSignature && address - kSignature < in.device.signature.size())
            return in.device.signature[address - kSignature];
        return std::nullopt;
    }
    bool write_byte(std::uint32_t address, std::uint8_t byte) {
        const avr::Chip::Inside in = chip_.inside();
        if (address < in.device.flash_bytes()) {
            const std::uint16_t word = in.core.program(address / 2);
            const int kept = address % 2 ? word & 0xFF : word & 0xFF00;
            in.core.set_program(address / 2,
                                static_cast<std::uint16_t>(kept | byte << (address % 2 ? 8 : 0)));
            return true;
        }
        if (const auto data = data_address(address)) {
            if (*data < kWorking) return write_register(*data, byte);
            if (*data >= in.device.ram_end()) return false;
            if (*data >= in.device.ram_start)
                in.core.ram()[*data - in.device.ram_start] = byte;
            else
                in.io.write(*data, byte, 0xFF);
            return true;
        }
        if (address < kEeprom || address - kEeprom >= in.device.eeprom_bytes) return false;
        chip_.eeprom()[address - kEeprom] = byte;
        return true;
    }

    avr::Chip& chip_;
    avr::ChipFaults faults_;
    std::vector<RegisterInfo> registers_;
};

}  // namespace

std::unique_ptr<DebugChip> make_debug_chip(avr::Chip& chip) {
    return std::make_unique<AvrDebugChip>(chip);
}

}  // namespace puckloop::debug
