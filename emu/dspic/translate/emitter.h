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
    Flow emit(Machine& m, const Op* op);
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
    /// The low byte alone with `byte_size`; bit 0 of W15 stays 0 (that uses eax).
    void store_w(int reg, const Xbyak::Reg32& from, bool byte_size);
    /// Checks the data address in eax plus `disp`: the index into RAM (of words, or bytes), or out.
    void ram_index(const Xbyak::Reg32& index, int disp, bool byte_size, bool stack, int words = 1);
    Xbyak::Address ram_cell(const Xbyak::Reg64& index, bool byte_size);
    /// A literal address in RAM; false if it is elsewhere.
    bool ram_literal(std::uint32_t address, bool byte_size, int& displacement) const;
    Xbyak::Address file_cell(int displacement, bool byte_size);
    void store_file(int displacement, const Xbyak::Reg32& from, bool byte_size);
    void source_index(const Op* op, const Xbyak::Reg32& index, bool byte_size, int words = 1);
    /// The same into ecx for an operand that is only read.
    void read_index(const Op* op, bool byte_size);
    void destination_index(const Op* op, const Xbyak::Reg32& index, bool byte_size, int words = 1);
    void step_pointer(int reg, int step, bool byte_size);
    void move_source(const Op* op, bool byte_size);
    void move_destination(const Op* op, bool byte_size);
    static bool can_reach(const Op* op);
    /// Checks the operands in RAM: index of the source in ecx, of the destination in edx. Uses eax.
    void reach(const Op* op, bool byte_size);
    void load_source(const Op* op, const Xbyak::Reg32& to, bool byte_size);
    void store_destination(const Op* op, const Xbyak::Reg32& from, bool byte_size);

    // registers.cpp
    void jump_unless_plain(Xbyak::Label& out, std::uint32_t cycles);
    /// As ram_index() into ecx for what is only read: leads to registers, too. Uses rax and rdx.
    void readable_index(int disp, bool byte_size);
    bool can_read_literal(std::uint32_t address, bool byte_size) const;
    /// Emits the check that reading is a look at what the address returned leads to. Uses rax, rcx and rdx.
    Xbyak::Address read_literal(std::uint32_t address, bool byte_size);
    /// A register of the core's own that is a field and nothing else.
    struct CoreRegister {
        int place = 0;  ///< from Machine::st
        std::uint32_t bits = 0;
    };
    std::optional<CoreRegister> core_register(std::uint32_t address) const;
    bool emit_clear_flag(const Op* op);

    // alu.cpp
    enum class Sum : std::uint8_t { Add, AddC, Sub, SubB, SubR, SubBR };
    enum class Logic : std::uint8_t { And, Ior, Xor };
    struct Two {
        bool sum = false;
        Sum adder{};
        Logic logic{};
    };
    enum class One : std::uint8_t {
        Inc,
        Inc2,
        Dec,
        Dec2,
        Neg,
        Com,
        Sl,
        Lsr,
        Asr,
        Rlnc,
        Rlc,
        Rrnc,
        Rrc,
        Clear,
        Set
    };
    enum class Shape : std::uint8_t { File, FileToW0, LiteralToW, Pointers };
    static std::optional<Two> two_operands(FormId form);
    static std::optional<One> one_operand(FormId form);
    static Shape shape_of(const Op* op);
    static bool takes_carry(const Two& two);
    /// Where combine() wants the base operand (Wb or f) and the other one.
    Xbyak::Reg32 base_register(const Two& two);
    Xbyak::Reg32 other_register(const Two& two);
    Xbyak::Reg32 combine(const Two& two, bool byte_size);
    void add_constant(std::uint32_t constant, int carry, bool byte_size);
    bool emit_alu(const Op* op);
    bool emit_two_operands(const Op* op, const Two& two);
    bool emit_one_operand(const Op* op);

    // shift.cpp, move.cpp, bits.cpp: false, and nothing emitted, for what they do not translate.
    Xbyak::Reg32 apply(One one, bool byte_size);
    bool emit_shift(const Op* op);
    bool emit_multiply(const Op* op);
    bool emit_move(const Op* op);
    bool emit_frame(const Op* op);
    bool emit_bits(const Op* op);
    bool emit_bit_test(const Op* op);
    void bit_to_z(std::uint32_t mask);

    // arrival.cpp
    void emit_arrival();
    void arrive(std::uint32_t extra_cycles);

    // flow.cpp
    void leave_taken(const Op* op, std::uint32_t target, std::uint32_t extra_cycles);
    void side_exit(const Op* op, int host_condition, std::uint32_t target, std::uint32_t extra_cycles);
    Flow emit_flow(Machine& m, const Op* op);
    Flow end_block(const Op* op);
    void emit_call(const Op* op);
    void emit_return(const Op* op);
    void emit_return_from_interrupt(const Op* op);
    /// Out if any interrupt or trap is requested, whatever its priority.
    void bail_if_requested();
    bool emit_skip(Machine& m, const Op* op);

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
