#include "emu/avr/core/core.h"

#include "emu/avr/core/run.h"
#include "emu/avr/machine/machine.h"
#include "emu/chip/translate/translation_switch.h"

#include <algorithm>
#include <utility>

namespace puckloop::avr {

namespace {

/// Runs off the end of the flash: the program counter wraps. No instruction, no time.
const Op* wrap(Machine& m, const Op* op) {
    m.cycle -= op->cycles;
    --m.instructions;
    return m.code + (static_cast<std::uint32_t>(op - m.code) - m.device.flash_words);
}

}  // namespace

Machine::Machine(const DeviceInfo& info, IoSpace& registers, EventQueue& queue,
                 InterruptController& controller)
    : ram_start(info.ram_start),
      ram_bytes(info.ram_bytes),
      device(info),
      io(registers),
      events(queue),
      irq(controller),
      program(info.flash_words + kGuards, kErasedWord),
      code_store(info.flash_words + kGuards),
      loops(info.flash_words) {
    for (Op& op : code_store)
        op.run = &decode_now;
    for (std::uint32_t i = info.flash_words; i < code_store.size(); ++i)
        code_store[i].run = &wrap;
    code = code_store.data();
    current = code;
    loop_info = loops.data();
    const chip::Translation wanted = chip::translation();
    translated.on = wanted.on;
    translated.hot = wanted.hot;
    hook_core_registers(*this);
    irq.set_listener(this, [](void* owner) {
        Machine& m = *static_cast<Machine*>(owner);
        if (m.sreg & sreg::I) m.limit = 0;
    });
}

Core::Core(const DeviceInfo& device, IoSpace& io, EventQueue& events, InterruptController& interrupts)
    : machine_(std::make_unique<Machine>(device, io, events, interrupts)) {}
Core::~Core() = default;

std::uint16_t Core::program(std::uint32_t address) const {
    return address < machine_->device.flash_words ? machine_->program[address] : kErasedWord;
}

void Core::set_program(std::uint32_t address, std::uint16_t word) {
    Machine& m = *machine_;
    if (address >= m.device.flash_words || m.program[address] == word) return;
    m.program_undo.note(address, m.program[address]);
    m.program[address] = word;
    forget(m, address);
    if (address < kGuards) m.program[m.device.flash_words + address] = word;  // a pair over the end
    if (address == 0) forget(m, m.device.flash_words - 1);
}

void Core::reset(ResetCause cause) {
    perform_reset(*machine_, cause);
}
void Core::request_reset(ResetCause cause) {
    machine_->reset_request = cause;
    machine_->limit = 0;
}
Core::Outcome Core::run(Cycle until) {
    return run_until(*machine_, until);
}
void Core::end_run() {
    machine_->end_requested = true;
    machine_->limit = 0;
}

void Core::step() {
    Machine& m = *machine_;
    const Cycle start = m.cycle;
    while (m.cycle == start)
        run_until(m, start + 1);
}

void Core::set_stops(std::span<const std::uint16_t> addresses) {
    Machine& m = *machine_;
    const auto old = m.stops;
    m.stops.assign(addresses.begin(), addresses.end());
    for (const auto& list : {old, m.stops})
        for (const std::uint16_t address : list)
            forget(m, address);
}

void Core::set_skip_idle(bool on) {
    machine_->skip_idle = on;
}

void Core::set_translate(bool on) {
    machine_->translated.on = on;
}

void Core::set_instrument(chip::Instrument* instrument, bool accesses) {
    Machine& m = *machine_;
    if (!m.instrument && instrument) {
        m.kept_skip = std::exchange(m.skip_idle, false);
        m.kept_translate = std::exchange(m.translated.on, false);
    } else if (m.instrument && !instrument) {
        m.skip_idle = m.kept_skip;
        m.translated.on = m.kept_translate;
    }
    m.instrument = instrument;
    m.ram_bytes = instrument && accesses ? 0 : m.device.ram_bytes;
}

void Core::stall_until(Cycle cycle) {
    machine_->stall_end = std::max(machine_->stall_end, cycle);
    machine_->limit = 0;
}
void Core::sleep(std::uint64_t wakers, std::uint32_t start_up) {
    machine_->asleep = true;
    machine_->wakers = wakers;
    machine_->start_up = start_up;
    machine_->limit = 0;
}
bool Core::sleeping() const {
    return machine_->asleep;
}
bool Core::rests() const {
    const Machine& m = *machine_;
    return m.asleep && !m.may_interrupt() && !m.reset_request && m.stall_end <= m.cycle;
}

Cycle Core::cycle() const {
    return machine_->cycle;
}
const Cycle& Core::now() const {
    return machine_->now;
}
void Core::set_now(Cycle now) {
    machine_->now = now;
}
std::uint16_t Core::pc() const {
    return machine_->pc_of(machine_->current);
}
std::uint64_t Core::instructions() const {
    return machine_->instructions;
}
Cycle Core::skipped() const {
    return machine_->skipped;
}
const DeviceInfo& Core::device() const {
    return machine_->device;
}

std::optional<WaitingLoop> Core::waiting() const {
    const Machine& m = *machine_;
    const SteadyLoop& loop = m.steady;
    // A walk begins where there is room for it: soon after whatever came between.
    constexpr Cycle kBetween = 20'000;
    if (loop.until == 0 || m.cycle > loop.until + kBetween || m.asleep) return std::nullopt;
    return WaitingLoop{loop.head, loop.branch, loop.polled, loop.reads_ram, loop.since};
}

CoreState Core::state() const {
    const Machine& m = *machine_;
    CoreState state;
    std::copy_n(m.data.begin(), state.r.size(), state.r.begin());
    state.sreg = m.sreg;
    state.rampz = m.rampz;
    state.sp = m.sp;
    state.pc = pc();
    state.cycle = m.cycle;
    return state;
}

void Core::set_state(const CoreState& state) {
    Machine& m = *machine_;
    std::copy(state.r.begin(), state.r.end(), m.data.begin());
    m.sreg = state.sreg;
    m.rampz = state.rampz & 1;
    m.sp = state.sp;
    m.current = m.code + state.pc;
    m.cycle = state.cycle;
    m.hold_at = kNoCycle;
    m.pass_pc.reset();
}

std::uint8_t Core::read_data(std::uint16_t address) {
    return load(*machine_, machine_->current, address);
}
void Core::write_data(std::uint16_t address, std::uint8_t value) {
    store(*machine_, machine_->current, address, value);
}
std::span<std::uint8_t> Core::ram() {
    return {machine_->data.data() + machine_->ram_start, machine_->device.ram_bytes};
}
CoreObserver& Core::observer() {
    return machine_->observer;
}
CoreHooks& Core::hooks() {
    return machine_->hooks;
}

}  // namespace puckloop::avr
