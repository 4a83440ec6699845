#pragma once
// Machine code for one block of operations, x86-64: what is the same for every chip family. A family derives
// its emitter from this one and brings what its instructions do. Host registers:
//   rbx  cycle at the block's start    r15  entries by program word    rdi  start of all code
//   Frame::base, Frame::count          rax, rcx, rdx                   scratch
// Nothing is called from here and no stack frame is made but the entry code's, so that no exception ever
// passes through. Whatever is not plain leaves the block before the instruction: the interpreter executes it.

#include "emu/chip/translate/left.h"

#include <xbyak/xbyak.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace puckloop::chip {

class BlockEmitter : protected Xbyak::CodeGenerator {
  public:
    /// Offsets of what every block shares, from the start of all code.
    struct Shared {
        std::uint32_t no_entry = 0, enter = 0, leave = 0;
        std::uint32_t own = 0;  ///< of the family, if it has any
    };
    virtual ~BlockEmitter() = default;
    BlockEmitter(const BlockEmitter&) = delete;
    BlockEmitter& operator=(const BlockEmitter&) = delete;

    /// The code at the start: what the unused entries (0) lead to, the way in and out, and the family's own.
    Shared emit_entry_code();
    std::size_t size() const { return getSize(); }
    /// Program words that the outcome rests on.
    std::uint32_t words() const { return words_; }

  protected:
    enum class Flow : std::uint8_t { Unknown, Next, Ended };
    static constexpr std::uint32_t kMostOperations = 32;

    /// Where code finds what every core has: distances from the address that it is entered with.
    struct Frame {
        Xbyak::Reg64 base;   ///< holds that address
        Xbyak::Reg64 count;  ///< instructions executed before the block
        int cycle, limit, instructions, code, current, entries;
        std::size_t operation_bytes;  ///< a decoded operation's
        std::uint32_t program_words;
    };

    /// Writes to `where`. The code at the start of all (emit_entry_code()) lies `offset` bytes before it.
    BlockEmitter(const Frame& frame, std::uint8_t* where, std::size_t room, std::size_t offset);

    // What a family brings.
    /// Host registers of its own, on the way in and out.
    virtual void load_registers() = 0;
    virtual void store_registers() {}
    /// Code that its blocks share beside those ways.
    virtual void emit_own() {}
    /// More of the block's head: whether it may be entered now; if not, to the label.
    virtual void emit_head(Xbyak::Label&) {}
    /// More operations may follow those so far.
    virtual bool goes_on() const = 0;
    /// The operation at index_: its code, and all counts after it. Unknown: it emitted nothing.
    virtual Flow emit_next() = 0;
    /// Flags and counts, as they are at this point, to where everybody finds them.
    virtual void settle() = 0;
    /// Brings the translator back to this point; for what is emitted after the block.
    virtual std::function<void()> point() = 0;

    /// Translates from program word `index` on, up to index_. False if not even one operation could be.
    bool emit_operations(std::uint32_t index, const Shared& shared);

    /// The instruction cannot be finished here: the label leads out before it. Nothing has changed yet.
    Xbyak::Label& bail();
    void finish_bail();
    /// What is to be emitted after the block, as of this point.
    void cold(const Xbyak::Label& label, std::function<void()> emit);
    /// A way out before the present instruction, nothing of it having happened.
    void leave_unchanged();
    void leave_before(std::uint32_t index, Left why);
    void go_to(std::uint32_t index);
    /// The same for the program word in ecx.
    void go_to_ecx();
    /// Counts cycles and instructions since the block's start.
    void account(std::uint32_t cycles, std::uint32_t steps);
    const void* at_start(std::uint32_t offset);

    Shared shared_;
    // The block so far.
    std::uint32_t start_ = 0;
    std::uint32_t words_ = 1;
    std::uint32_t index_ = 0;   ///< program word of the present operation
    std::uint32_t cycles_ = 0;  ///< from the block's start to the present operation
    std::uint32_t steps_ = 0;   ///< operations before the present one

  private:
    struct Cold {
        Xbyak::Label label;
        std::function<void()> emit;
    };

    const Frame frame_;
    const std::size_t offset_;
    Xbyak::Label entry_;
    bool bailed_ = false;
    Xbyak::Label bail_;
    std::function<void()> bail_point_;
    std::vector<Cold> cold_;
};

}  // namespace puckloop::chip
