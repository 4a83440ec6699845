// Branches, calls and returns, and what happens at a taken backward branch (idle_loops.h,
// wait_watch.h).

#include "emu/dspic/machine/exception_frame.h"
#include "emu/dspic/translate/emitter.h"

namespace puckloop::dspic::translate {

using namespace Xbyak::util;

namespace {

struct Condition {
    Test test;
    bool holds;  ///< taken if the test holds
};

std::optional<Condition> condition_of(FormId form) {
    switch (form) {
        // clang-format off
    case FormId::BRA_OV_Expr: return Condition{Test::Overflow, true};
    case FormId::BRA_NOV_Expr: return Condition{Test::Overflow, false};
    case FormId::BRA_C_Expr: return Condition{Test::Carry, true};
    case FormId::BRA_NC_Expr: return Condition{Test::Carry, false};
    case FormId::BRA_Z_Expr: return Condition{Test::Zero, true};
    case FormId::BRA_NZ_Expr: return Condition{Test::Zero, false};
    case FormId::BRA_N_Expr: return Condition{Test::Negative, true};
    case FormId::BRA_NN_Expr: return Condition{Test::Negative, false};
    case FormId::BRA_LT_Expr: return Condition{Test::Less, true};
    case FormId::BRA_GE_Expr: return Condition{Test::Less, false};
    case FormId::BRA_LE_Expr: return Condition{Test::LessOrEqual, true};
    case FormId::BRA_GT_Expr: return Condition{Test::LessOrEqual, false};
    case FormId::BRA_LEU_Expr: return Condition{Test::NotAbove, true};
    case FormId::BRA_GTU_Expr: return Condition{Test::NotAbove, false};
        // clang-format on
    default:
        return std::nullopt;
    }
}

/// Pushed by CALL and RCALL: two words.
constexpr int kReturnBytes = 4;

}  // namespace

void Emitter::leave_taken(const Op* op, std::uint32_t target, std::uint32_t extra_cycles) {
    flush_flags();
    account(cycles_ + stall_ + op->cycles + extra_cycles, steps_ + 1, keep_ & op->keep, op->writes);
    go_to(target);
}

void Emitter::side_exit(const Op* op, int host_condition, std::uint32_t target, std::uint32_t extra_cycles) {
    Xbyak::Label taken;
    jump_if(host_condition, taken);
    cold(taken, [this, op, target, extra_cycles] { leave_taken(op, target, extra_cycles); });
}

Emitter::Flow Emitter::emit_flow(const Op* op) {
    const std::optional<Condition> condition_wanted = condition_of(op->form);
    const std::uint32_t target = op->target / 2;
    // Longer ones never skip; may_skip decides which of the others do.
    constexpr std::uint32_t kFarthestArrival = 66;
    const bool arrives = target <= index_ && index_ - target <= kFarthestArrival;
    if (condition_wanted || op->form == FormId::BRA_Expr || op->form == FormId::GOTO_Expr) {
        if (target >= layout_.code_words) return Flow::Unknown;
        if (!condition_wanted) {
            flush_flags();
            if (arrives) arrive(0);
            finish_bail();
            leave_taken(op, target, 0);
            return end_block(op);
        }
        if (!arrives) {
            const int host = condition(condition_wanted->test) ^ (condition_wanted->holds ? 0 : 1);
            side_exit(op, host, target, 1);
            finish_step(op);
            return Flow::Next;
        }
        // Both ways want SR whole.
        Flags before = flags_;
        flush_flags();
        std::swap(before, flags_);
        const int host = condition(condition_wanted->test) ^ (condition_wanted->holds ? 0 : 1);
        flags_ = {};
        side_exit(op, host ^ 1, index_ + 1, std::uint32_t{0});
        arrive(1);
        finish_bail();
        leave_taken(op, target, 1);
        return end_block(op);
    }
    switch (op->form) {
    case FormId::NOP:
    case FormId::NOPR:
        finish_step(op);
        return Flow::Next;
    case FormId::CALL_Expr:
    case FormId::RCALL_Expr:
        if (target >= layout_.code_words) return Flow::Unknown;
        emit_call(op);
        finish_bail();
        leave_taken(op, target, 0);
        return end_block(op);
    case FormId::RETURN:
        emit_return(op);
        return end_block(op);
    case FormId::RETFIE:
        emit_return_from_interrupt(op);
        return end_block(op);
    case FormId::DISI_lit14:
        // While somebody waits the interpreter finds out whether it may still come in.
        bail_if_requested();
        lea(rax, ptr[rbx + static_cast<int>(cycles_ + 1 + op->k)]);
        mov(qword[rbp + layout_.disi_end], rax);
        finish_step(op);
        return Flow::Next;
    default:
        return Flow::Unknown;
    }
}

Emitter::Flow Emitter::end_block(const Op* op) {
    ++steps_;
    index_ += form(op->form).two_words() ? 2 : 1;
    return Flow::Ended;
}

void Emitter::emit_call(const Op* op) {
    load_w(eax, 15, false);
    // The second word is the higher one; below the first one RAM ends too.
    lea(ecx, ptr[rax + 2 - kRamStart]);
    cmp(ecx, dword[rbp + layout_.stack_span]);
    jg(bail(), T_NEAR);
    ram_index(edx, 0, false, false, 2);
    mov(dword[r12 + rdx * 2], 2 * index_ + op->k);
    add(w_word(15), kReturnBytes);
}

void Emitter::emit_return(const Op* op) {
    flush_flags();
    cmp(byte[rbp + layout_.eligible], 0);  // then it takes a cycle less
    jne(bail(), T_NEAR);
    load_w(eax, 15, false);
    lea(ecx, ptr[rax - 2 - kRamStart]);
    cmp(ecx, dword[rbp + layout_.stack_span]);
    jg(bail(), T_NEAR);
    ram_index(edx, -kReturnBytes, false, false, 2);
    mov(ecx, dword[r12 + rdx * 2]);
    and_(ecx, 0x7FFFFE);
    shr(ecx, 1);
    cmp(ecx, layout_.code_words);
    jae(bail(), T_NEAR);
    finish_bail();
    add(w_word(15), -kReturnBytes);
    account(cycles_ + stall_ + op->cycles, steps_ + 1, keep_ & op->keep, op->writes);
    go_to_ecx();
}

void Emitter::bail_if_requested() {
    mov(rax, qword[rbp + layout_.line]);
    cmp(dword[rax + static_cast<int>(offsetof(InterruptController::Line, first.level))], 0);
    jne(bail(), T_NEAR);
}

/// From a user interrupt to code that nothing interrupts next and that is not repeated.
void Emitter::emit_return_from_interrupt(const Op* op) {
    flush_flags();
    bail_if_requested();
    test(byte[rbp + layout_.corcon], corcon::IPL3);
    jne(bail(), T_NEAR);
    load_w(eax, 15, false);
    lea(ecx, ptr[rax - 2 - kRamStart]);
    cmp(ecx, dword[rbp + layout_.stack_span]);
    jg(bail(), T_NEAR);
    ram_index(edx, -kReturnBytes, false, false, 2);
    mov(ecx, dword[r12 + rdx * 2]);  // PC<15:0>; PC<22:16>, IPL3, SR<7:0>
    constexpr std::uint32_t kHigh = 16, kStatus = 24;
    test(ecx, std::uint32_t{kStackedIpl3} << kHigh | std::uint32_t{sr::RA} << kStatus);
    jne(bail(), T_NEAR);
    mov(edx, ecx);
    and_(ecx, 0x7FFFFE);
    shr(ecx, 1);
    cmp(ecx, layout_.code_words);
    jae(bail(), T_NEAR);
    finish_bail();
    shr(edx, kStatus);
    movzx(eax, word[rbp + layout_.sr]);
    mov(al, dl);
    mov(word[rbp + layout_.sr], ax);
    add(w_word(15), -kReturnBytes);
    mov(byte[rbp + layout_.repeat_first], 1);
    account(cycles_ + stall_ + op->cycles, steps_ + 1, keep_ & op->keep, op->writes);
    go_to_ecx();
}

}  // namespace puckloop::dspic::translate
