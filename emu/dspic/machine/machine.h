#pragma once
// The inside of Core (core/): pre-decoded operations, the machine they run on, and the short inline paths
// that every instruction uses (RAM, pointers, the W registers).

#include "emu/chip/instrument.h"
#include "emu/dspic/devices/device.h"
#include "emu/dspic/machine/core_observer.h"
#include "emu/dspic/machine/core_state.h"
#include "emu/dspic/machine/event_queue.h"
#include "emu/dspic/machine/exception_frame.h"
#include "emu/dspic/machine/gate.h"
#include "emu/dspic/machine/interrupts.h"
#include "emu/dspic/machine/isa.h"
#include "emu/dspic/machine/memory_map.h"
#include "emu/dspic/machine/program_pages.h"
#include "emu/dspic/machine/program_undo.h"
#include "emu/dspic/machine/sfr_space.h"
#include "emu/dspic/machine/shortcuts.h"
#include "emu/dspic/machine/stays.h"
#include "emu/dspic/machine/translated.h"

#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::dspic {

struct Machine;
struct Op;

/// Executes `op` and returns the operation to execute next.
using Handler = const Op* (*)(Machine& m, const Op* op);

/// How an operand is reached, fixed when the word is decoded.
enum class Ea : std::uint8_t { Direct, Literal, Indirect, Offset };

/// The form of words that are no instruction.
inline constexpr FormId kNoForm{0xFF};

/// One program word, ready to run. `run` is decode_now() until the word is first reached.
struct Op {
    Handler run = nullptr;     ///< what the loop calls
    Handler base = nullptr;    ///< the instruction itself, behind a stop address or a loop end
    std::uint32_t uses = 0;    ///< low half: source pointers (stall); high half: every pointer (must be set)
    std::uint32_t writes = 0;  ///< low half: registers that stall a source pointer in the next instruction
    std::uint32_t keep = 0;    ///< what stays of Machine::watch: high half, less the registers it sets
    std::uint32_t target = 0;  ///< branch target or loop end, program-counter units
    std::uint16_t k = 0;       ///< literal, data address, bit mask or shift
    std::uint8_t d = 0, s = 0, b = 0;  ///< W numbers: destination, source, base
    std::uint8_t aux = 0;              ///< bit number, accumulator, pair code: as the handler needs
    std::int8_t s_pre = 0, s_post = 0, d_pre = 0, d_post = 0;  ///< pointer steps in bytes
    std::uint8_t cycles = 1;
    std::uint8_t psv_extra = 0;
    std::uint8_t marks = 0;  ///< kStop, kLoopEnd
    FormId form = kNoForm;
    Ea source = Ea::Literal;  ///< how the source operand is reached (for idle_loops.cpp)
    Ea destination = Ea::Literal;
    bool byte = false;
    bool may_skip = false;  ///< a backward branch whose loop is worth analysing
    std::uint32_t word = 0;
};
inline constexpr std::uint8_t kStop = 1, kLoopEnd = 2;

/// Guard operations behind the last flash word: three for running off the end, one for every other address.
inline constexpr std::uint32_t kGuards = 4;

// Of fast/, which makes execution quick.
struct IdleLoops;
class LoopUndo;
struct KnownServices;

struct Machine {
    /// Made by core/core.cpp, which knows all of its parts.
    Machine(const DeviceInfo& info, SfrSpace& registers, EventQueue& queue, InterruptController& controller);
    ~Machine();

    CoreState st;
    // Hot, beside the state.
    const Op* current = nullptr;  ///< the operation being executed, or next to execute between instructions
    Cycle until = 0;              ///< the end of the run in progress
    Cycle limit = 0;              ///< the inner loop leaves when st.cycle reaches this; 0 = leave now
    std::uint32_t watch = 0;      ///< low half: just written; high half: not written since reset
    std::uint16_t special = 0x8000;  ///< pointer registers that need special_ea(): W15, modulo, bit-reversed
    std::int32_t stack_span = 0xFFFF;  ///< highest legal stack address less kRamStart; below 0: none is
    std::uint16_t ram_words = 0;       ///< 0 while an instrument sees accesses
    std::uint16_t* ram = nullptr;
    Op* code = nullptr;
    std::uint32_t code_words = 0;
    std::uint64_t instructions = 0;
    EventQueue& events;
    SfrSpace& sfr;
    InterruptController& irq;
    const DeviceInfo& device;

    // Interrupts.
    bool eligible = false;  ///< irq.first() may interrupt now ...
    Cycle since = 0;        ///< ... since this cycle
    bool disi_waits = false;
    InterruptController::Line* line = nullptr;  ///< of irq, for translated code
    SfrSpace::Plain* plain = nullptr;           ///< of sfr, for translated code
    std::optional<ResetCause> reset_request;
    std::uint32_t fault_pc = 0;
    bool daw_clears_carry = false;  ///< Erratum::DawCarry

    // Repeated instructions.
    bool repeat_first = false;  ///< the next iteration follows REPEAT or a return from interrupt
    bool repeat_edge = false;   ///< first, last, or next to an interrupt: a PSV read costs extra
    Cycle late = 0;             ///< cycles of PSV reads, added when the instruction is over

    // Outside flash.
    std::uint32_t outside_pc = 0;

    // Stops.
    std::vector<std::uint32_t> stops;
    bool stopped = false;
    bool end_requested = false;  ///< Core::end_run()
    Gate gate;
    std::optional<std::uint32_t> pass_pc;  ///< this stop was reported; execute it next time

    // Power, stalls, watchdog.
    PowerMode mode = PowerMode::Run;
    Cycle stall_end = 0;
    bool held = false;          ///< in reset
    double wake_seconds = 0.0;  ///< from what ends Sleep to the first instruction
    Cycle wake_end = kNoCycle;  ///< the oscillator starts, until then
    double cycle_rate = 0.0;    ///< 0: not set yet
    struct Doze {
        bool on = false;             ///< CLKDIV<DOZEN>
        bool recovers = false;       ///< CLKDIV<ROI>
        Cycle ratio = 1;             ///< cycles in a CPU cycle
        Cycle entry = 0;             ///< where the instruction began that set DOZEN
        Cycle remaining_cycles = 0;  ///< CPU cycles that the instruction under way still takes
    } doze;
    EventQueue::Slot watchdog_slot = 0;
    Cycle watchdog_cleared = 0;

    // Flash and EEPROM programming (nvm.cpp).
    struct Nvm {
        std::uint32_t address = 0;  ///< NVMADRU:NVMADR, or the last table write on the 33FJ
        int key_step = 0;           ///< 0x55 and 0xAA seen so far
        std::vector<std::uint32_t> latch;
        EventQueue::Slot slot = 0;
    } nvm;

    ProgramPages pages;
    std::span<std::uint32_t> program;  ///< raw words of flash, guards included
    std::vector<std::uint16_t> ram_store;
    std::vector<std::uint16_t> eeprom;
    std::vector<std::uint32_t> config;
    std::vector<std::uint32_t> unit_id;

    std::function<void(ResetCause)> reset_hook;
    std::function<void(PowerMode)> power_hook;
    std::function<void()> rcon_hook;
    CoreObserver observer;
    chip::Instrument* instrument = nullptr;
    bool kept_skip = true, kept_translate = true;  ///< what holds again without an instrument
    bool anew = false;                             ///< a reset was performed since the instrument was asked
    std::vector<std::uint32_t> warned;
    bool skip_idle = true;
    std::unique_ptr<IdleLoops> skip;
    /// Into `skip`, for translated code: a branch's place plus 1 by program word (null: none is known), and
    /// by place how many arrivals it waits.
    std::uint16_t* loop_index = nullptr;
    std::uint16_t* loop_waits = nullptr;
    ProgramUndo program_undo;
    std::unique_ptr<LoopUndo> loop_undo;
    std::unique_ptr<KnownServices> services;
    WaitWatch waits;
    Translated translated;

    std::uint32_t pc_of(const Op* op) const {
        const auto index = static_cast<std::uint32_t>(op - code);
        return index == code_words + kGuards - 1 ? outside_pc : index * 2;
    }
    /// True where the gate is in the way of the operation that is next: the run ends there.
    bool stops_at(const Op* op) {
        if (st.cycle < gate.from) [[likely]]
            return false;
        gate.held = may_access(*this, op);
        return gate.held;
    }
    void bound_limit() {
        if (events.next() < limit) limit = events.next();
    }
};

/// The operation at a program address; addresses without flash lead to the last guard.
inline const Op* at(Machine& m, std::uint32_t pc) {
    const std::uint32_t index = pc >> 1;
    if (index < m.code_words) [[likely]]
        return m.code + index;
    m.outside_pc = pc & kProgramSpace;
    return m.code + m.code_words + kGuards - 1;
}

// Slow paths and events (memory.cpp, decode.cpp, exceptions.cpp, resets.cpp).
std::uint16_t read16_slow(Machine& m, std::uint16_t address);
std::uint16_t read8_slow(Machine& m, std::uint16_t address);
void write16_slow(Machine& m, std::uint16_t address, std::uint16_t value);
void write8_slow(Machine& m, std::uint16_t address, std::uint16_t value);
std::uint16_t special_ea(Machine& m, int reg, int pre, int post, bool write, bool word);
std::uint16_t special_offset(Machine& m, int reg, std::uint16_t offset, bool write);
std::uint16_t modulo_y(Machine& m, int reg, int step);
void raise_trap(Machine& m, Trap trap);
void request_reset(Machine& m, ResetCause cause);
void perform_reset(Machine& m, ResetCause cause);
/// Recomputes whether the first interrupt in line may be taken; `now` = since when.
void reconsider(Machine& m, Cycle now);
void update_pointer_rules(Machine& m);
void mark(Machine& m, std::uint32_t pc, std::uint8_t what);
void warn_once(Machine& m, std::uint32_t key, std::string_view text);
std::uint32_t read_program(const Machine& m, std::uint32_t address, bool* implemented = nullptr);
bool write_program(Machine& m, std::uint32_t address, std::uint32_t word);
/// As write_program(), with no word to what was decoded from it.
bool store_program(Machine& m, std::uint32_t address, std::uint32_t word);
void invalidate(Machine& m, std::uint32_t address);
/// The operation is to be decoded again when it is next reached.
void blank(Machine& m, std::uint32_t index);
Op blank_operation(std::uint32_t word);
/// After many words were stored: nothing that was decoded from them or is known of them holds any more.
void renew_code(Machine& m);
const Op* decode_now(Machine& m, const Op* op);
void decode(Machine& m, Op& op);
void hook_registers(Machine& m);
void reset_registers(Machine& m);
// nvm.cpp
void table_write(Machine& m, std::uint32_t address, bool high, bool byte, std::uint16_t value);
void hook_nvm(Machine& m);
void reset_nvm(Machine& m, ResetCause cause, std::uint16_t nvmcon_before);
// power.cpp
void hook_power(Machine& m);
void clear_watchdog(Machine& m);
void enter_power_save(Machine& m, PowerMode mode);
void leave_power_save(Machine& m);
std::uint16_t& rcon_register(Machine& m);
void schedule_watchdog(Machine& m);
// doze.cpp
/// CLKDIV was written or reset.
void doze_changed(Machine& m);
/// An exception is accepted at the end of the present CPU cycle: with ROI it ends Doze.
void recover(Machine& m);
/// The instruction that began at `began` is over: its cycles are the CPU's, and Machine::st counts the
/// chip's.
void stretch(Machine& m, Cycle began);
/// One CPU cycle of those that the instruction under way still takes.
void consume_cycle(Machine& m);
/// A return, which is a cycle shorter while an exception waits to be taken.
inline bool shortened_by_exception(const Op& op) {
    return op.form == FormId::RETURN || op.form == FormId::RETLW_lit10_Wn || op.form == FormId::RETFIE;
}

inline int cpu_level(const Machine& m) {
    return (m.st.sr >> sr::kIplShift & 7) | (m.st.corcon & corcon::IPL3);
}

inline std::uint16_t read16(Machine& m, std::uint16_t address) {
    // Rotating the offset right by one turns an odd address into an index that is out of range.
    const auto index = std::rotr(static_cast<std::uint16_t>(address - kRamStart), 1);
    if (index < m.ram_words) [[likely]]
        return m.ram[index];
    return read16_slow(m, address);
}

inline void write16(Machine& m, std::uint16_t address, std::uint16_t value) {
    const auto index = std::rotr(static_cast<std::uint16_t>(address - kRamStart), 1);
    if (index < m.ram_words) [[likely]]
        m.ram[index] = value;
    else
        write16_slow(m, address, value);
}

inline std::uint16_t read8(Machine& m, std::uint16_t address) {
    const auto offset = static_cast<std::uint16_t>(address - kRamStart);
    if (offset >> 1 < m.ram_words) [[likely]]
        return static_cast<std::uint16_t>(m.ram[offset >> 1] >> (8 * (offset & 1)) & 0xFF);
    return read8_slow(m, address);
}

inline void write8(Machine& m, std::uint16_t address, std::uint16_t value) {
    const auto offset = static_cast<std::uint16_t>(address - kRamStart);
    if (offset >> 1 < m.ram_words) [[likely]] {
        const int shift = 8 * (offset & 1);
        std::uint16_t& word = m.ram[offset >> 1];
        word = static_cast<std::uint16_t>((word & ~(0xFF << shift)) | (value & 0xFF) << shift);
    } else {
        write8_slow(m, address, value);
    }
}

template <bool Byte>
std::uint16_t read_data(Machine& m, std::uint16_t address) {
    return Byte ? read8(m, address) : read16(m, address);
}
template <bool Byte>
void write_data(Machine& m, std::uint16_t address, std::uint16_t value) {
    if constexpr (Byte)
        write8(m, address, value);
    else
        write16(m, address, value);
}

/// Writes a whole W register; bit 0 of W15 does not exist.
inline void set_w(Machine& m, int reg, std::uint32_t value) {
    m.st.w[static_cast<std::size_t>(reg)] = static_cast<std::uint16_t>(value & ~std::uint32_t(reg == 15));
}
inline std::uint16_t get_w(const Machine& m, int reg) {
    return m.st.w[static_cast<std::size_t>(reg)];
}
/// A byte result leaves the upper half alone.
template <bool Byte>
void put_w(Machine& m, int reg, std::uint32_t value) {
    set_w(m, reg, Byte ? (get_w(m, reg) & 0xFF00u) | (value & 0xFF) : value);
}

inline void check_stack(Machine& m, std::uint16_t address) {
    if (static_cast<std::uint16_t>(address - kRamStart) > m.stack_span) [[unlikely]]
        raise_trap(m, Trap::StackError);
}
inline void push(Machine& m, std::uint16_t value) {
    const std::uint16_t address = m.st.w[15];
    check_stack(m, address);
    write16(m, address, value);
    m.st.w[15] = static_cast<std::uint16_t>(address + 2);
}
inline std::uint16_t pop(Machine& m) {
    const auto address = static_cast<std::uint16_t>(m.st.w[15] - 2);
    m.st.w[15] = address;
    check_stack(m, address);
    return read16(m, address);
}

/// [W15] with its modifications; compilers compare by subtracting to [W15], so this is common.
inline std::uint16_t stack_ea(Machine& m, int pre, int post) {
    const auto address = static_cast<std::uint16_t>(m.st.w[15] + pre);
    m.st.w[15] = static_cast<std::uint16_t>((address + post) & 0xFFFE);
    check_stack(m, address);
    return address;
}

/// [Wn] with every pre- and post-modification: steps are in the operation.
template <bool Word = true>
std::uint16_t source_ea(Machine& m, const Op* op) {
    if (m.special >> op->s & 1) [[unlikely]] {
        if (op->s == 15) return stack_ea(m, op->s_pre, op->s_post);
        return special_ea(m, op->s, op->s_pre, op->s_post, false, Word);
    }
    std::uint16_t& pointer = m.st.w[op->s];
    const auto address = static_cast<std::uint16_t>(pointer + op->s_pre);
    pointer = static_cast<std::uint16_t>(address + op->s_post);
    return address;
}
template <bool Word = true>
std::uint16_t destination_ea(Machine& m, const Op* op) {
    if (m.special >> op->d & 1) [[unlikely]] {
        if (op->d == 15) return stack_ea(m, op->d_pre, op->d_post);
        return special_ea(m, op->d, op->d_pre, op->d_post, true, Word);
    }
    std::uint16_t& pointer = m.st.w[op->d];
    const auto address = static_cast<std::uint16_t>(pointer + op->d_pre);
    pointer = static_cast<std::uint16_t>(address + op->d_post);
    return address;
}
inline std::uint16_t offset_ea(Machine& m, int reg, std::uint16_t offset, bool write) {
    if (m.special >> reg & 1) [[unlikely]]
        return special_offset(m, reg, offset, write);
    return static_cast<std::uint16_t>(get_w(m, reg) + offset);
}

template <bool Byte, Ea Mode>
std::uint16_t source(Machine& m, const Op* op) {
    if constexpr (Mode == Ea::Literal) return op->k;
    if constexpr (Mode == Ea::Direct)
        return static_cast<std::uint16_t>(Byte ? m.st.w[op->s] & 0xFF : m.st.w[op->s]);
    if constexpr (Mode == Ea::Indirect) return read_data<Byte>(m, source_ea<!Byte>(m, op));
    if constexpr (Mode == Ea::Offset) return read_data<Byte>(m, offset_ea(m, op->s, m.st.w[op->b], false));
}
template <bool Byte, Ea Mode>
void destination(Machine& m, const Op* op, std::uint32_t value) {
    if constexpr (Mode == Ea::Direct) put_w<Byte>(m, op->d, value);
    if constexpr (Mode == Ea::Indirect)
        write_data<Byte>(m, destination_ea<!Byte>(m, op), static_cast<std::uint16_t>(value));
    if constexpr (Mode == Ea::Offset)
        write_data<Byte>(m, offset_ea(m, op->d, m.st.w[op->b], true), static_cast<std::uint16_t>(value));
}

/// True if the word begins a two-word instruction: what a skip has to step over.
inline bool is_two_words(std::uint32_t word) {
    const std::uint32_t high = word >> 16;
    return high == 0x02 || high == 0x04 || high == 0x08;
}
/// Over the next instruction, with the cycles that costs.
inline const Op* skip_next(Machine& m, const Op* op) {
    const bool two = is_two_words(op[1].word);
    m.st.cycle += two ? 2 : 1;
    return op + (two ? 3 : 2);
}

/// Sets the SR bits in `mask`.
inline void set_flags(Machine& m, std::uint32_t mask, std::uint32_t bits) {
    m.st.sr = static_cast<std::uint16_t>((m.st.sr & ~mask) | bits);
}
/// N and Z of a result.
template <bool Byte>
std::uint32_t nz(std::uint32_t result) {
    const std::uint32_t r = Byte ? result & 0xFF : result & 0xFFFF;
    return (r == 0 ? sr::Z : 0u) | (r >> (Byte ? 7 : 15) & 1) << 3;
}

// Each group of instructions binds its forms: picks the handler, fills the operands. False = not its form.
bool bind_alu(Op& op, const Form& form, std::uint32_t word);
bool bind_shift(Op& op, const Form& form, std::uint32_t word);
bool bind_move(Op& op, const Form& form, std::uint32_t word);
bool bind_bits(Op& op, const Form& form, std::uint32_t word);
bool bind_multiply(Op& op, const Form& form, std::uint32_t word);
bool bind_flow(Op& op, const Form& form, std::uint32_t word, std::uint32_t word2, std::uint32_t pc);
bool bind_dsp(Op& op, const Form& form, std::uint32_t word);

/// Fills s, s_pre, s_post and the pointer masks for mode letter `mode` (p or g) and register letter s.
/// Size in bytes of one step. Returns how the operand is reached.
Ea bind_source(Op& op, const Form& form, std::uint32_t word, char mode, int size);
/// The same for the destination (q or h, register d).
Ea bind_destination(Op& op, const Form& form, std::uint32_t word, char mode, int size);
/// Registers the operation writes as a destination: they stall a following source pointer and are set.
inline void sets(Op& op, int reg) {
    op.writes |= 1u << reg;
    op.keep &= ~(0x10000u << reg);
}
/// Registers that are set without a stall (implicit writes).
inline void initialises(Op& op, int reg) {
    op.keep &= ~(0x10000u << reg);
}

}  // namespace puckloop::dspic
