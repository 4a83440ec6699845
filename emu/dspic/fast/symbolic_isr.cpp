#include "emu/dspic/fast/symbolic_isr.h"

#include "emu/dspic/machine/execute/semantics.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr int kMostInRoutine = 32;

}  // namespace

SymbolicIsr::SymbolicIsr(const Machine& m, IsrSummary& result, int irq) : m_(m), summary_(result), irq_(irq) {
    for (std::uint16_t reg = 0; reg < 16; ++reg)
        w_[reg] = {Word::Register, reg};
    w_[15] = {Word::StackOffset, kExceptionFrame};
    slots_.push_back({0, Word::ReturnLow, 0});
    slots_.push_back({2, Word::ReturnHigh, 0});
}

SymbolicIsr::End SymbolicIsr::run(const Op* op) {
    try {
        return walk(op);
    } catch (const Stop&) {
        return End::Never;
    }
}

SymbolicIsr::End SymbolicIsr::walk(const Op* op) {
    summary_.keep = 0xFFFFFFFF;
    std::uint32_t writes = 0;
    for (int i = 0; i < kMostInRoutine; ++i) {
        if (op->run == &decode_now) return End::NotYet;
        if (op->marks) return End::Never;
        if (op->uses & writes & 0xFFFF) ++summary_.cycles;
        summary_.uses |= op->uses & 0xFFFF0000 & summary_.keep;
        summary_.keep &= op->keep;
        writes = op->writes;
        summary_.cycles += op->cycles;
        ++summary_.instructions;
        if (op->form == FormId::RETFIE) {
            summary_.writes = writes;
            return restored() ? End::Done : End::Never;
        }
        op = execute_in(*this, op);
        if (op == nullptr) return End::Never;
    }
    return End::Never;
}

/// Everything is as it was found, but for words above the stack pointer; these become the summary's pushes.
bool SymbolicIsr::restored() const {
    if (w_[15] != Value{Word::StackOffset, kExceptionFrame} || !flag_cleared_) return false;
    for (std::uint16_t reg = 0; reg < 15; ++reg)
        if (w_[reg] != Value{Word::Register, reg}) return false;
    if (slots_.size() > IsrSummary::kMost) return false;
    std::copy(slots_.begin(), slots_.end(), summary_.pushes.begin());
    summary_.push_count = slots_.size();
    return true;
}

std::uint32_t SymbolicIsr::word(Value value) {
    if (value.kind != Word::Constant) throw Stop{};
    return value.value;
}

void SymbolicIsr::set_whole(int reg, Value value) {
    if (reg == 15) {
        if (value.kind != Word::StackOffset || value.value < kExceptionFrame || value.value & 1) throw Stop{};
        reach(value.value);
    }
    w_[static_cast<std::size_t>(reg)] = value;
}

SymbolicIsr::Value SymbolicIsr::plus(Value value, std::uint16_t offset) {
    if (value.kind != Word::Constant && value.kind != Word::StackOffset) throw Stop{};
    return {value.kind, static_cast<std::uint16_t>(value.value + offset)};
}

/// Words that the routine itself put on the stack; the interrupted program's are not its own.
SymbolicIsr::Value SymbolicIsr::load(Address at, bool byte) const {
    if (at.kind != Word::StackOffset || byte || at.value < kExceptionFrame) throw Stop{};
    for (const IsrSummary::Push& slot : slots_)
        if (slot.offset == at.value) return {slot.kind, slot.value};
    throw Stop{};
}

void SymbolicIsr::store(Address at, bool byte, Value value) {
    if (byte) throw Stop{};
    if (at.kind == Word::Constant) return refresh(at.value, static_cast<std::uint16_t>(word(value)));
    if (at.kind != Word::StackOffset || at.value < kExceptionFrame || at.value & 1) throw Stop{};
    reach(at.value + 2u);
    const auto slot = std::find_if(slots_.begin(), slots_.end(),
                                   [&](const IsrSummary::Push& known) { return known.offset == at.value; });
    const IsrSummary::Push push{at.value, value.kind, value.value};
    if (slot == slots_.end())
        slots_.push_back(push);
    else
        *slot = push;
}

/// A module's register: may be written what it holds.
void SymbolicIsr::refresh(std::uint16_t address, std::uint16_t value) {
    if (address < kWEnd || address >= kRamStart || address & 1 || !m_.sfr.idempotent(address) ||
        summary_.refresh_count == IsrSummary::kMost)
        throw Stop{};
    summary_.refreshes[summary_.refresh_count++] = {address, value};
}

void SymbolicIsr::clear_flag(Address at, bool byte, std::uint32_t set, std::uint32_t cleared) {
    const auto flag = static_cast<std::uint16_t>(m_.device.ifs + irq_ / 8);
    if (!byte || at != address(flag) || set != 0 || cleared != 1u << irq_ % 8) throw Stop{};
    flag_cleared_ = true;
}

}  // namespace puckloop::dspic
