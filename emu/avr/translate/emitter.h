#pragma once
// What a block's machine code (emu/chip/translate/block_emitter.h) is made of for the AVR. Host registers
// beside those of every family:
//   r12  Machine             r13  data space              r14  instructions executed before the block
//   rbp  tables (layout.h)   r10  0                       r11  Z of a chain of SBC, SBCI, CPC so far
//   rsi  scratch
// Working registers, SREG and RAM stay in memory.
//
// The host's flags after an addition, subtraction or shift are the AVR's. They stay where they are (Pending)
// until something that the host has to do would lose them; what is in SREG is only brought up to date where
// somebody can see it: at every way out of the block, and where an instruction reads it that the host's own
// flags cannot serve.

#include "emu/avr/translate/layout.h"
#include "emu/avr/translate/library.h"
#include "emu/chip/translate/block_emitter.h"

#include <functional>
#include <vector>

namespace puckloop::avr::translate {

class Emitter : public chip::BlockEmitter {
  public:
    /// Writes to `where`. The code at the start of all (emit_entry_code()) lies `offset` bytes before it.
    Emitter(const Layout& layout, std::uint8_t* where, std::size_t room, std::size_t offset);

    /// Translates from program word `index` on. False if not even one operation could be.
    bool emit_block(Machine& m, std::uint32_t index, const Shared& shared);

  private:
    /// A longer block would more often be cut by the limit.
    static constexpr std::uint32_t kMostCycles = 48;

    // block.cpp
    struct Step {
        const Op* op = nullptr;
        std::uint32_t words = 1;
        std::uint8_t live = 0;  ///< flags that somebody may read behind it
    };
    void load_registers() override;
    bool goes_on() const override { return steps_ < plan_.size(); }
    Flow emit_next() override;
    void settle() override;
    std::function<void()> point() override;
    void gather(Machine& m, std::uint32_t index);
    Flow emit(const Op* op);

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
    std::vector<Step> plan_;

    // The block so far.
    Pending pending_;
    std::uint8_t live_ = 0xFF;
};

/// What an operation does to flags: those it reads, if of its own only those in `live` matter, and those it
/// always writes. Whatever can leave the block shows all of them.
struct FlagUse {
    std::uint8_t reads = 0, writes = 0;
};
FlagUse flag_use(const Op& op, std::uint8_t live, const Layout& layout);

}  // namespace puckloop::avr::translate
