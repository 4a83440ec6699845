#pragma once
// Machine code for one block of operations, x86-64. Host registers:
//   r12  Machine             r13  data space              rbx  cycle at the block's start
//   r14  instructions executed before it                  r15  entries by program word
//   rbp  tables (layout.h)   rdi  start of all code       r10  0
//   r11  Z of a chain of SBC, SBCI, CPC so far            rax, rcx, rdx, rsi scratch
// Working registers, SREG and RAM stay in memory. Nothing is called from here and no stack frame is made but
// the entry code's. Whatever is not plain leaves the block before the instruction: the interpreter executes
// it.
//
// The host's flags after an addition, subtraction or shift are the AVR's. They stay where they are (Pending)
// until something that the host has to do would lose them; what is in SREG is only brought up to date where
// somebody can see it: at every way out of the block, and where an instruction reads it that the host's own
// flags cannot serve.

#include "emu/avr/translate/layout.h"
#include "emu/avr/translate/library.h"

#include <xbyak/xbyak.h>

#include <functional>
#include <vector>

namespace puckloop::avr::translate {

class Emitter : private Xbyak::CodeGenerator {
  public:
    /// Writes to `where`. The code at the start of all (emit_entry_code()) lies `offset` bytes before it.
    Emitter(const Layout& layout, std::uint8_t* where, std::size_t room, std::size_t offset);

    /// Offsets of what every block shares, from the start of all code.
    struct Shared {
        std::uint32_t no_entry = 0, enter = 0, leave = 0;
    };
    /// The code at the start: what the unused entries (0) lead to, the way in and out.
    Shared emit_entry_code();
    std::size_t size() const { return getSize(); }

    /// Translates from program word `index` on. False if not even one operation could be.
    bool emit_block(Machine& m, std::uint32_t index, const Shared& shared);
    /// Program words that the outcome rests on.
    std::uint32_t words() const { return words_; }

  private:
    enum class Flow : std::uint8_t { Unknown, Next, Ended };
    static constexpr std::uint32_t kMostOperations = 32;
    /// A longer block would more often be cut by the limit.
    static constexpr std::uint32_t kMostCycles = 48;

    // block.cpp
    struct Step {
        const Op* op = nullptr;
        std::uint32_t index = 0;
        std::uint8_t live = 0;  ///< flags that somebody may read behind it
    };
    void gather(Machine& m, std::uint32_t index);
    Flow emit(const Step& step);
    void leave_before(std::uint32_t index, Left why);
    void account(std::uint32_t cycles, std::uint32_t steps);
    void go_to(std::uint32_t index);
    const void* at_start(std::uint32_t offset);
    /// What is to happen behind the block, with this point's flags and counts.
    void cold(Xbyak::Label& label, std::function<void()> emit);
    /// A label that leaves before the present operation.
    Xbyak::Label& bail();
    void finish_bail();

    // flags.cpp
    struct Pending {
        std::uint8_t mask = 0;  ///< flags that the host's flags have; 0: SREG has all
        bool shift = false;     ///< V is N ^ C
        bool chain = false;     ///< Z is in r11
    };
    void set_pending(std::uint8_t mask, bool shift = false, bool chain = false);
    /// SREG up to date. Loses the host's flags.
    void flush();
    /// The operation will lose the host's flags and set those of `written` anew.
    void lose_flags(std::uint8_t written = 0);

    // alu.cpp, memory.cpp, flow.cpp: false, and nothing emitted, for what they do not translate.
    bool emit_alu(const Op* op);
    bool emit_shift(const Op* op);
    bool emit_multiply(const Op* op);
    bool emit_bits(const Op* op);
    bool emit_memory(const Op* op);
    Flow emit_flow(const Op* op);
    void with_carry(const Op* op, bool chained, const std::function<void()>& operation);

    Xbyak::Address reg(unsigned number) { return byte[r13 + static_cast<int>(number)]; }
    Xbyak::Address pair_of(unsigned low) { return word[r13 + static_cast<int>(low)]; }
    Xbyak::Address sreg_byte() { return byte[r12 + layout_.sreg]; }
    bool is_ram(std::uint32_t address) const { return address - layout_.ram_start < layout_.ram_bytes; }
    /// Leaves unless eax is the address of RAM. Keeps the host's flags; uses ecx.
    void check_ram();
    struct Access {
        unsigned pointer = 0;  ///< 26, 28 or 30
        int before = 0, after = 0, displacement = 0;
    };
    static bool access_of(const Op* op, Access& access, bool& loads);
    void emit_call(const Op* op, std::uint32_t words);
    void emit_return(const Op* op);
    void branch(const Op* op);
    void taken(const Op* op, std::uint32_t target, std::uint32_t extra_cycles);
    void arrive(const Op* op, std::uint32_t target);
    bool arrives(std::uint32_t target) const;
    void skip(const Op* op, bool when_zero);

    const Layout& layout_;
    std::size_t offset_;
    Shared shared_;
    std::vector<Step> plan_;

    // The block so far.
    std::uint32_t start_ = 0;
    Xbyak::Label entry_;
    std::uint32_t words_ = 1;
    Pending pending_;
    std::uint8_t live_ = 0xFF;
    std::uint32_t index_ = 0;   ///< program word of the present operation
    std::uint32_t cycles_ = 0;  ///< from the block's start to the present operation
    std::uint32_t steps_ = 0;   ///< operations before the present one
    bool bailed_ = false;
    Xbyak::Label bail_;
    Pending bail_pending_;
    struct Cold {
        Xbyak::Label label;
        std::function<void()> emit;
    };
    std::vector<Cold> cold_;
};

/// What an operation does to flags: those it reads, if of its own only those in `live` matter, and those it
/// always writes. Whatever can leave the block shows all of them.
struct FlagUse {
    std::uint8_t reads = 0, writes = 0;
};
FlagUse flag_use(const Op& op, std::uint8_t live, const Layout& layout);

}  // namespace puckloop::avr::translate
