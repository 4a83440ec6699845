#include "bench/debugger/stack.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

namespace puckloop::exec::debugger {

namespace {

constexpr int kMostScanned = 2048;  // bytes of stack between two frames

std::optional<std::uint32_t> word_at(const debug::DebugChip& chip, std::uint16_t address, int bytes) {
    std::array<std::uint8_t, 4> cell{};
    if (!chip.read_memory(debug::DebugChip::address_of_data(address),
                          std::span(cell).first(static_cast<std::size_t>(bytes))))
        return std::nullopt;
    return cell[0] | cell[1] << 8 | cell[2] << 16 | static_cast<std::uint32_t>(cell[3]) << 24;
}

/// The address that a disassembled call names, if it names one ("call 0x1f4 ..." as the disassemblers write
/// it).
std::optional<std::uint32_t> target_of(const std::string& text) {
    const std::size_t at = text.find("0x");
    if (at == std::string::npos) return std::nullopt;
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data() + at + 2, text.data() + text.size(), value, 16);
    return error == std::errc{} ? std::optional(value) : std::nullopt;
}

/// Whether a call of the function of `callee` ends right before `address`.
bool follows_call(const debug::DebugChip& chip, const Program& program, std::uint32_t address,
                  std::uint32_t callee) {
    for (const std::uint32_t size : {2u, 4u}) {
        if (address < size || !chip.is_code(address - size)) continue;
        const debug::Instruction before = chip.instruction(address - size);
        if (before.flow != debug::Flow::Call || before.size != size) continue;
        const auto target = target_of(before.text);
        if (!target || program.function_of(*target) == program.function_of(callee)) return true;
    }
    return false;
}

struct Slot {
    std::uint32_t pc = 0;
    std::uint16_t stack = 0;  ///< once it is taken off
};

/// The return address that ends at `sp` towards the stack's top, whatever it is.
std::optional<Slot> slot_at(const debug::DebugChip& chip, std::uint16_t sp) {
    if (chip.stack_grows_up()) {  // PC<15:0>, then PC<22:16> with SR's low byte or CORCON's IPL3 above it
        constexpr std::uint16_t kBytes = 4;
        if (sp < chip.ram_start() + kBytes) return std::nullopt;
        const auto at = static_cast<std::uint16_t>(sp - kBytes);
        const auto words = word_at(chip, at, kBytes);
        if (!words) return std::nullopt;
        return Slot{(*words & 0xFFFE) | (*words >> 16 & 0x7F) << 16, at};
    }
    if (sp + 2u >= chip.ram_end()) return std::nullopt;  // the high byte is on top, both in words
    const auto words = word_at(chip, static_cast<std::uint16_t>(sp + 1), 2);
    if (!words) return std::nullopt;
    return Slot{((*words & 0xFF) << 8 | *words >> 8) * 2, static_cast<std::uint16_t>(sp + 2)};
}

}  // namespace

bool deeper(const debug::DebugChip& chip, std::uint16_t left, std::uint16_t right) {
    return chip.stack_grows_up() ? left > right : left < right;
}

std::vector<Frame> backtrace(const debug::DebugChip& chip, const Program& program, std::size_t most) {
    std::vector<Frame> frames{{chip.pc(), chip.stack_pointer(), false, chip.pc()}};
    std::uint16_t sp = chip.stack_pointer();
    const int step = chip.stack_grows_up() ? -2 : 1;
    while (frames.size() < most) {
        const std::uint32_t callee = frames.back().pc;
        const std::string name = program.function_name(callee);
        // C's names of interrupt routines: _T1Interrupt, __vector_5.
        const bool interrupt = program.is_interrupt_entry(program.function_of(callee)) ||
                               name.ends_with("Interrupt") || name.starts_with("__vector_");
        std::optional<Slot> found;
        bool called = false;
        for (int scanned = 0; scanned < kMostScanned && !called; ++scanned) {
            const int at = sp + step * scanned;
            if (at < static_cast<int>(chip.ram_start()) || at >= static_cast<int>(chip.ram_end())) break;
            const auto slot = slot_at(chip, static_cast<std::uint16_t>(at));
            if (!slot || !chip.is_code(slot->pc) || slot->pc == 0) continue;
            if (interrupt) {
                // Any instruction may have been interrupted: the first address within a known function.
                called = !program.function_name(slot->pc).empty() && program.line_of(slot->pc).line != 0;
            } else {
                called = follows_call(chip, program, slot->pc, callee);
            }
            if (called) found = slot;
        }
        if (!found) break;
        frames.back().interrupt = interrupt;
        frames.push_back({found->pc, found->stack, false, interrupt ? found->pc : found->pc - 2});
        sp = found->stack;
    }
    return frames;
}

}  // namespace puckloop::exec::debugger
