#pragma once
// What a block's machine code (emu/chip/translate/block_emitter.h) is made of for the dsPIC. Host registers
// beside those of every family:
//   rbp  &Machine::st        r13  instructions executed before the block
//   r12  data RAM            r14d Machine::watch
//   r8d, r9d, r10d adder's operands and sum; r11d a result; esi a carry (flags.h)
// W registers, SR and RAM stay in memory.

#include "emu/chip/translate/block_emitter.h"
#include "emu/dspic/translate/flags.h"
#include "emu/dspic/translate/layout.h"
#include "emu/dspic/translate/library.h"

#include <functional>
#include <optional>

namespace puckloop::dspic::translate {

class Emitter : public chip::BlockEmitter {
  public:
    /// Words behind a block that it looks at: where a skip leads depends on them.
    static constexpr std::uint32_t kLookedAt = 2;

    /// Writes to `where`. The code at the start of all (emit_entry_code()) lies `offset` bytes before it.
    Emitter(const Layout& layout, std::uint8_t* where, std::size_t room, std::size_t offset);

    /// Translates from program word `index` on. False if not even one operation could be. The words that it
    /// rests on include the ones looked at.
    bool emit_block(Machine& m, std::uint32_t index, const Shared& shared);

  private:
    static constexpr int kRamStart = 0x0800;
    /// A longer block would more often be cut by the limit.
    static constexpr std::uint32_t kMostCycles = 32;

    // block.cpp
    void load_registers() override;
    void store_registers() override;
    void emit_own() override { emit_arrival(); }
    void emit_head(Xbyak::Label& late) override;
    bool goes_on() const override { return steps_ < kMostOperations && cycles_ < kMostCycles; }
    Flow emit_next() override;
    void settle() override;
    std::function<void()> point() override;
    Flow emit(const Op* op);
    void finish_step(const Op* op);
    /// Counts the cycles and steps since the block's start, and what they do to Machine::watch.
    void account(std::uint32_t cycles, std::uint32_t steps, std::uint32_t keep, std::uint32_t writes);

    // flags.cpp
    /// Puts into SR what is not there yet. Uses eax, ecx, edx.
    void flush_flags();
    void set_sum(bool byte_size, int carry, bool sticky);
    void set_result(bool byte_size);
    void carry_to(const Xbyak::Reg32& reg);
    /// Sets the host's flags; the condition returned (low bits of a jump's opcode) then means `which`.
    int condition(Test which);
    void jump_if(int host_condition, Xbyak::Label& label);

    // operands.cpp
    Xbyak::Address w_word(int reg) { return word[rbp + (layout_.w + 2 * reg)]; }
    Xbyak::Address w_byte(int reg) { return byte[rbp + (layout_.w + 2 * reg)]; }
    Xbyak::Address w_double(int reg) { return dword[rbp + (layout_.w + 2 * reg)]; }
    void load_w(const Xbyak::Reg32& to, int reg, bool byte_size);
    /// Checks the data address in eax plus `disp`: the index into RAM (of words, or bytes), or out.
    void ram_index(const Xbyak::Reg32& index, int disp, bool byte_size, bool stack, int words = 1);
    /// A literal address in RAM; false if it is elsewhere.
    bool ram_literal(std::uint32_t address, bool byte_size, int& displacement) const;
    Xbyak::Address file_cell(int displacement, bool byte_size);

    // registers.cpp
    void jump_unless_plain(Xbyak::Label& out, std::uint32_t cycles);
    /// As ram_index() into ecx for what is only read: leads to registers, too. Uses rax and rdx.
    void readable_index(int disp, bool byte_size);
    bool can_read_plain(std::uint32_t address, bool byte_size) const;
    /// Emits the check that reading this register is a look at plain_cell(), now. Uses rax, rcx and rdx.
    void check_plain(std::uint32_t address);
    /// By rcx, as check_plain() leaves it.
    Xbyak::Address plain_cell(std::uint32_t address, bool byte_size);
    /// A register of the core's own that is a field and nothing else.
    struct CoreRegister {
        int place = 0;  ///< from Machine::st
        std::uint32_t bits = 0;
    };
    std::optional<CoreRegister> core_register(std::uint32_t address) const;
    bool emit_clear_flag(const Op* op);

    // recipe_code.cpp
    friend class RecipeCode;
    /// False, and nothing emitted, for what is not translated.
    bool emit_recipe(const Op* op);

    // arrival.cpp
    void emit_arrival();
    void arrive(std::uint32_t extra_cycles);

    // flow.cpp
    void leave_taken(const Op* op, std::uint32_t target, std::uint32_t extra_cycles);
    void side_exit(const Op* op, int host_condition, std::uint32_t target, std::uint32_t extra_cycles);
    Flow emit_flow(const Op* op);
    Flow end_block(const Op* op);
    void emit_call(const Op* op);
    void emit_return(const Op* op);
    void emit_return_from_interrupt(const Op* op);
    /// Out if any interrupt or trap is requested, whatever its priority.
    void bail_if_requested();

    const Layout& layout_;
    Machine* machine_ = nullptr;  ///< whose program it is

    // The block so far.
    Flags flags_;
    std::uint32_t stall_ = 0;  ///< cycles, of the present one
    std::uint32_t keep_ = 0xFFFFFFFF;
    std::uint32_t writes_ = 0;  ///< of the operation before
    std::uint32_t needs_ = 0;   ///< pointers that must have been written at its start
    std::size_t needs_at_ = 0;  ///< where the code has them
};

}  // namespace puckloop::dspic::translate
