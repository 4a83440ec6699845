#pragma once
// The inside of Core (core/): pre-decoded operations, the machine they run on, and the short inline paths
// that every instruction uses.

#include "emu/avr/devices/device.h"
#include "emu/avr/isa/isa.h"
#include "emu/avr/machine/core_observer.h"
#include "emu/avr/machine/interrupts.h"
#include "emu/avr/machine/memory_undo.h"
#include "emu/avr/machine/shortcuts.h"
#include "emu/avr/machine/state.h"
#include "emu/avr/machine/translated.h"
#include "emu/chip/instrument.h"

#include <optional>
#include <vector>

namespace puckloop::avr {

struct Op;

/// Executes `op` and returns the operation to execute next; the run loop adds op->cycles.
using Handler = const Op* (*)(Machine& m, const Op* op);

/// One program word, ready to run. `run` is decode_now() until the word is first reached.
struct Op {
    Handler run = nullptr;
    std::uint16_t k = 0;  ///< constant, data address or target's word address
    std::uint8_t d = 0;   ///< destination register
    std::uint8_t r = 0;   ///< source register
    std::uint8_t b = 0;   ///< mask of the one bit that field b or s names
    std::uint8_t cycles = 0;
    std::uint8_t skip = 0;  ///< operations from here to the one behind the next instruction
    FormId form = FormId::Undefined;
};
static_assert(sizeof(Op) == 16, "four operations to a cache line");

/// Behind the last flash word: the program counter wraps. Two, because the last word may begin a pair.
inline constexpr std::uint32_t kGuards = 2;

/// What is known about a backward branch (fast/idle_loops.cpp).
struct LoopInfo {
    std::uint16_t wait = 0;     ///< visits until its turns are looked at again
    std::uint8_t patience = 0;  ///< failures in a row
    std::uint32_t period = 0;   ///< cycles of its last turn that was looked at; 0: none was
};

/// The steady loop in which the program was last seen to wait (fast/idle_loops.cpp).
struct SteadyLoop {
    std::uint16_t head = 0, branch = 0;  ///< program words
    std::uint16_t polled = 0;            ///< register that it reads; 0: none
    bool reads_ram = false;
    std::uint32_t registers = 0;  ///< fingerprint: another one is another wait
    Cycle since = 0, until = 0;
};

/// Longer loops are no busy waits.
inline constexpr std::uint32_t kLongestLoop = 64;

struct Machine {
    /// Made by core/core.cpp.
    Machine(const DeviceInfo& info, IoSpace& registers, EventQueue& queue, InterruptController& controller);

    // Hot: what nearly every instruction touches.
    std::uint8_t sreg = 0;
    std::uint16_t sp = 0;
    Cycle cycle = 0;  ///< of the instruction's start
    Cycle limit = 0;  ///< the inner loop leaves when `cycle` reaches this; 0 = leave now
    std::uint64_t instructions = 0;
    const Op* code = nullptr;
    std::uint32_t ram_start = 0, ram_bytes = 0;  ///< no bytes while an instrument sees accesses
    std::array<std::uint8_t, 0x10000>
        data{};  ///< working registers and RAM; the registers between are in `io`

    const Op* current = nullptr;  ///< next to execute; inside hooks: being executed
    std::uint8_t rampz = 0;
    Cycle now = 0;             ///< of the access or event in progress
    Cycle hold_at = kNoCycle;  ///< the instruction that starts here comes before any interrupt
    Cycle stall_end = 0;
    Cycle skipped = 0;      ///< cycles of turns that were not executed one by one
    Cycle quiet_since = 0;  ///< the inner loop was entered here
    bool skip_idle = true;
    bool asleep = false;
    std::uint64_t wakers = 0;    ///< vectors that end this sleep
    std::uint32_t start_up = 0;  ///< clocks from such a request to the first one of the CPU
    bool stopped = false;
    bool end_requested = false;
    std::optional<std::uint16_t> pass_pc;  ///< this stop was reported; execute it next time
    std::optional<ResetCause> reset_request;

    const DeviceInfo& device;
    IoSpace& io;
    EventQueue& events;
    InterruptController& irq;
    std::vector<std::uint16_t> program;  ///< guards included
    std::vector<Op> code_store;
    std::vector<LoopInfo> loops;
    LoopInfo* loop_info = nullptr;  ///< their first
    Translated translated;
    std::vector<std::uint16_t> stops;
    bool started = false;           ///< the program was at address 0 since the last reset
    std::int16_t last_vector = -1;  ///< of the interrupt taken last since then
    SteadyLoop steady;
    MemoryUndo<std::uint16_t> program_undo;
    std::vector<std::uint32_t> warned;
    CoreObserver observer;
    CoreHooks hooks;
    chip::Instrument* instrument = nullptr;
    bool kept_skip = true, kept_translate = true;  ///< what holds again without an instrument
    bool anew = false;                             ///< a reset was performed since the instrument was asked

    std::uint16_t pc_of(const Op* op) const { return static_cast<std::uint16_t>(op - code); }
    bool may_interrupt() const { return (sreg & sreg::I) && (asleep ? irq.any(wakers) : irq.any()); }
};

/// Every event due by `horizon`, each at its own `now`.
inline void serve_events(Machine& m, Cycle horizon) {
    while (m.events.next() <= horizon) {
        m.now = m.events.next();
        m.events.service(m.now);
    }
}

// execute/decode.cpp
const Op* decode_now(Machine& m, const Op* op);
void decode(Machine& m, Op& op);
void forget(Machine& m, std::uint32_t address);
// resets.cpp
void perform_reset(Machine& m, ResetCause cause);
// memory.cpp
std::uint8_t load_outside_ram(Machine& m, const Op* op, std::uint16_t address);
void store_outside_ram(Machine& m, const Op* op, std::uint16_t address, std::uint8_t value,
                       std::uint8_t mask);
void write_sreg(Machine& m, const Op* op, std::uint8_t value);
std::uint8_t load_program(Machine& m, const Op* op, std::uint32_t address);
void hook_core_registers(Machine& m);
bool was_warned(const Machine& m, std::uint32_t key);
void warn_once(Machine& m, const Op* op, std::uint32_t key, std::string_view text);

/// Every access takes the slow path while an instrument wants to see it.
inline bool shows_accesses(const Machine& m) {
    return m.ram_bytes == 0;
}

inline std::uint8_t load(Machine& m, const Op* op, std::uint16_t address) {
    if (address - m.ram_start < m.ram_bytes) [[likely]]
        return m.data[address];
    return load_outside_ram(m, op, address);
}
inline void store(Machine& m, const Op* op, std::uint16_t address, std::uint8_t value) {
    if (address - m.ram_start < m.ram_bytes) [[likely]]
        m.data[address] = value;
    else
        store_outside_ram(m, op, address, value, 0xFF);
}

/// Pointer registers X, Y and Z: their low halves.
inline constexpr std::uint8_t kX = 26, kY = 28, kZ = 30;

inline std::uint16_t pair(const Machine& m, std::uint8_t low) {
    return static_cast<std::uint16_t>(m.data[low] | m.data[low + 1u] << 8);
}
inline void set_pair(Machine& m, std::uint8_t low, std::uint32_t value) {
    m.data[low] = static_cast<std::uint8_t>(value);
    m.data[low + 1u] = static_cast<std::uint8_t>(value >> 8);
}

inline void push(Machine& m, const Op* op, std::uint8_t value) {
    store(m, op, m.sp--, value);
}
inline std::uint8_t pop(Machine& m, const Op* op) {
    return load(m, op, ++m.sp);
}
/// The high byte ends at the lower address.
inline void push_pc(Machine& m, const Op* op, std::uint32_t pc) {
    push(m, op, static_cast<std::uint8_t>(pc));
    push(m, op, static_cast<std::uint8_t>(pc >> 8));
}

}  // namespace puckloop::avr
