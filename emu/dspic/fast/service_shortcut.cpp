#include "emu/dspic/fast/service_shortcut.h"

#include "emu/dspic/core/machine.h"
#include "emu/dspic/fast/loop_undo.h"

#include <bit>

namespace puckloop::dspic {

namespace {

using Word = ServiceShortcut::Word;

constexpr int kMostInstructions = 32;

/// The routine, executed with names for what it finds: registers by their numbers, the stack by offsets.
class Walk {
  public:
    Walk(const Machine& m, ServiceShortcut& result, int irq) : m_(m), shortcut_(result), irq_(irq) {
        for (std::uint16_t reg = 0; reg < 16; ++reg)
            w_[reg] = {Word::Register, reg};
        w_[15] = {Word::StackOffset, kExceptionFrame};
        slots_.push_back({0, Word::ReturnLow, 0});
        slots_.push_back({2, Word::ReturnHigh, 0});
    }

    enum class End : std::uint8_t { Done, NotYet, Never };
    End run(const Op* op) {
        shortcut_.keep = 0xFFFFFFFF;
        std::uint32_t writes = 0;
        for (int i = 0; i < kMostInstructions; ++i, ++op) {
            if (op->run == &decode_now) return End::NotYet;
            if (op->marks) return End::Never;
            if (op->uses & writes & 0xFFFF) ++shortcut_.cycles;
            shortcut_.uses |= op->uses & 0xFFFF0000 & shortcut_.keep;
            shortcut_.keep &= op->keep;
            writes = op->writes;
            shortcut_.cycles += op->cycles;
            ++shortcut_.instructions;
            if (op->form == FormId::RETFIE) {
                shortcut_.writes = writes;
                return finish() ? End::Done : End::Never;
            }
            if (!step(op)) return End::Never;
        }
        return End::Never;
    }

  private:
    struct Value {
        Word kind{};
        std::uint16_t value = 0;
        bool operator==(const Value&) const = default;
    };

    bool push(Value value) {
        if (w_[15].kind != Word::StackOffset) return false;
        const std::uint16_t offset = w_[15].value;
        bool found = false;
        for (ServiceShortcut::Push& slot : slots_)
            if (slot.offset == offset) {
                slot = {offset, value.kind, value.value};
                found = true;
            }
        if (!found) slots_.push_back({offset, value.kind, value.value});
        return move_stack(static_cast<std::uint16_t>(offset + 2));
    }
    bool move_stack(std::uint16_t offset) {
        w_[15] = {Word::StackOffset, offset};
        if (offset > shortcut_.depth) shortcut_.depth = offset;
        return slots_.size() <= ServiceShortcut::kMost;
    }
    std::optional<Value> pop() {
        if (w_[15].kind != Word::StackOffset || w_[15].value <= kExceptionFrame) return std::nullopt;
        w_[15].value = static_cast<std::uint16_t>(w_[15].value - 2);
        for (const ServiceShortcut::Push& slot : slots_)
            if (slot.offset == w_[15].value) return Value{slot.kind, slot.value};
        return std::nullopt;
    }
    bool set(int reg, std::optional<Value> value) {
        if (!value || reg == 15) return false;
        w_[static_cast<std::size_t>(reg)] = *value;
        return true;
    }

    bool step(const Op* op) {
        switch (op->form) {
        case FormId::NOP:
            return true;
        case FormId::MOV_Ws_Wd: {
            if (op->byte) return false;
            const bool pushes = op->source == Ea::Direct && op->destination == Ea::Indirect && op->d == 15 &&
                                op->d_pre == 0 && op->d_post == 2;
            const bool pops = op->source == Ea::Indirect && op->s == 15 && op->s_pre == -2 &&
                              op->s_post == 0 && op->destination == Ea::Direct;
            if (pushes) return push(w_[op->s]);
            return pops && set(op->d, pop());
        }
        case FormId::MOV_D_Wns_Wd:
            if (op->destination != Ea::Indirect || op->d != 15 || op->d_pre != 0 || op->d_post != 4)
                return false;
            return push(w_[op->s]) && push(w_[op->s + 1u]);
        case FormId::MOV_D_Ws_Wnd: {
            if (op->source != Ea::Indirect || op->s != 15 || op->s_pre != -4 || op->s_post != 0) return false;
            const std::optional<Value> high = pop();
            return set(op->d + 1, high) && set(op->d, pop());
        }
        case FormId::MOV_lit16_Wnd:
            return set(op->d, Value{Word::Constant, op->k});
        case FormId::LNK_lit14:
            if (!push(w_[14])) return false;
            w_[14] = w_[15];
            return move_stack(static_cast<std::uint16_t>(w_[15].value + op->k));
        case FormId::ULNK:
            if (w_[14].kind != Word::StackOffset) return false;
            w_[15] = w_[14];
            return set(14, pop());
        case FormId::MOV_Wns_f:
            return refresh(op->k, w_[op->s]);
        case FormId::BCLR_f_bit4:
            return clears_own_flag(op);
        default:
            return false;
        }
    }

    bool refresh(std::uint16_t address, Value value) {
        if (value.kind != Word::Constant || address >= 2 * SfrSpace::kWords) return false;
        if (!m_.sfr.idempotent(address) || shortcut_.refresh_count == ServiceShortcut::kMost) return false;
        shortcut_.refreshes[shortcut_.refresh_count++] = {address, value.value};
        return true;
    }
    bool clears_own_flag(const Op* op) {
        const int bit = std::countr_zero(static_cast<unsigned>(op->aux));
        const bool own = op->k == m_.device.ifs + irq_ / 8 && bit == irq_ % 8;
        flag_cleared_ = flag_cleared_ || own;
        return own;
    }

    bool finish() {
        if (w_[15] != Value{Word::StackOffset, kExceptionFrame} || !flag_cleared_) return false;
        for (std::uint16_t reg = 0; reg < 15; ++reg)
            if (w_[reg] != Value{Word::Register, reg}) return false;
        for (const ServiceShortcut::Push& slot : slots_)
            shortcut_.pushes[shortcut_.push_count++] = slot;
        return true;
    }

    const Machine& m_;
    ServiceShortcut& shortcut_;
    int irq_;
    std::array<Value, 16> w_{};
    std::vector<ServiceShortcut::Push> slots_;
    bool flag_cleared_ = false;
};

}  // namespace

const ServiceShortcut* service_shortcut(Machine& m, int vector) {
    if (vector < kTrapVectors) return nullptr;
    auto& known = m.shortcuts.known;
    const auto index = static_cast<std::size_t>(vector);
    if (known.size() <= index) known.resize(index + 1);
    const std::uint32_t table = m.irq.alternate_table() ? m.device.aivt : m.device.ivt;
    const std::uint32_t handler = m.program[table / 2 + index] & kProgramSpace;
    if (known[index] && known[index]->handler == handler)
        return known[index]->possible ? &*known[index] : nullptr;
    if (handler / 2 + kMostInstructions >= m.code_words) return nullptr;
    ServiceShortcut fresh;
    fresh.handler = handler;
    switch (Walk(m, fresh, vector - kTrapVectors).run(m.code + handler / 2)) {
    case Walk::End::NotYet:
        return nullptr;
    case Walk::End::Done:
        fresh.possible = true;
        break;
    case Walk::End::Never:
        break;
    }
    m.loop_undo->note_shortcut(index, known[index]);
    known[index] = fresh;
    return fresh.possible ? &*known[index] : nullptr;
}

bool stack_holds(const Machine& m, const ServiceShortcut& shortcut, std::uint16_t stack) {
    const auto lowest = static_cast<std::uint16_t>(stack - kRamStart);
    return lowest + shortcut.depth <= m.stack_span && lowest / 2 + shortcut.depth / 2 <= m.ram_words;
}

bool refreshes_hold(const Machine& m, const ServiceShortcut& shortcut) {
    for (std::size_t i = 0; i < shortcut.refresh_count; ++i)
        if (m.sfr.raw(shortcut.refreshes[i].address) != shortcut.refreshes[i].value) return false;
    return true;
}

void push_trace(Machine& m, const ServiceShortcut& shortcut, const Interrupted& interrupted) {
    const std::uint16_t stack = interrupted.w[15];
    std::uint16_t* const words = m.ram + (stack - kRamStart) / 2;
    for (std::size_t i = 0; i < shortcut.push_count; ++i) {
        const ServiceShortcut::Push& push = shortcut.pushes[i];
        std::uint32_t value = push.value;
        switch (push.kind) {
        case Word::Register:
            value = interrupted.w[push.value];
            break;
        case Word::Constant:
            break;
        case Word::StackOffset:
            value = stack + push.value;
            break;
        case Word::ReturnLow:
            value = stacked_pc_low(interrupted.pc);
            break;
        case Word::ReturnHigh:
            value = stacked_status(interrupted.sr, m.st.corcon, interrupted.pc);
            break;
        }
        words[push.offset / 2] = static_cast<std::uint16_t>(value);
    }
}

}  // namespace puckloop::dspic
