#include "emu/dspic/core/core.h"

#include "base/error.h"
#include "emu/chip/translate/translation_switch.h"
#include "emu/dspic/core/run.h"
#include "emu/dspic/fast/idle_loops.h"
#include "emu/dspic/fast/known_services.h"
#include "emu/dspic/fast/loop_undo.h"
#include "emu/dspic/machine/machine.h"
#include "emu/dspic/waits/wait_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace puckloop::dspic {

namespace {

/// Configuration words of a part that nobody has programmed: no watchdog by them.
std::vector<std::uint32_t> erased_configuration(const DeviceInfo& info) {
    std::vector<std::uint32_t> words(info.config_words, 0xFFFF);
    constexpr std::size_t kFwdt30F = 1;
    constexpr std::size_t kFwdt33F = 5;
    if (!info.family_33f && words.size() > kFwdt30F) words[kFwdt30F] = 0x7FFF;
    if (info.family_33f && words.size() > kFwdt33F) words[kFwdt33F] = 0xFF7F;
    return words;
}

}  // namespace

Machine::Machine(const DeviceInfo& info, SfrSpace& registers, EventQueue& queue,
                 InterruptController& controller)
    : events(queue),
      sfr(registers),
      irq(controller),
      device(info),
      pages(info.flash_end / 2, kGuards),
      program(pages.words()),
      skip(std::make_unique<IdleLoops>()),
      loop_undo(std::make_unique<LoopUndo>()),
      services(std::make_unique<KnownServices>()) {
    code_words = info.flash_end / 2;
    code = pages.operations();
    current = code;
    line = &irq.line();
    plain = &sfr.plain();
    ram_store.assign((info.ram_end - info.ram_start) / 2u, 0);
    ram = ram_store.data();
    ram_words = static_cast<std::uint16_t>(ram_store.size());
    eeprom.assign(info.eeprom_words, 0xFFFF);
    config = erased_configuration(info);
    unit_id.assign(info.unit_id_words, 0xFFFFFF);
    hook_registers(*this);
    hook_power(*this);
    hook_nvm(*this);
    irq.set_clock(&st.cycle, &st.disi_end);
    irq.set_listener(this, [](void* owner, Cycle now) { reconsider(*static_cast<Machine*>(owner), now); });
    reset_registers(*this);
    const chip::Translation wanted = chip::translation();
    translated.on = wanted.on;
    translated.hot = wanted.hot;
}

Machine::~Machine() = default;

Core::Core(const DeviceInfo& device, SfrSpace& sfr, EventQueue& events, InterruptController& interrupts)
    : machine_(std::make_unique<Machine>(device, sfr, events, interrupts)) {}

Core::~Core() = default;

void Core::load(std::span<const ProgramWord> words) {
    constexpr std::size_t kFew = 256;
    constexpr std::uint32_t kWordMask = 0xFFFFFF;
    const bool many = words.size() > kFew;
    for (const ProgramWord& word : words)
        if (many ? !store_program(*machine_, word.address & ~1u, word.word & kWordMask)
                 : !poke_program(word.address, word.word))
            throw InputError("", fmt::format("address 0x{:06X}", word.address),
                             fmt::format("{} has no memory there", machine_->device.name),
                             fmt::format("flash below 0x{:06X}, EEPROM or configuration words",
                                         machine_->device.flash_end));
    if (many) renew_code(*machine_);
}
void Core::reprogram(std::span<const ProgramWord> words) {
    constexpr std::uint32_t kWordMask = 0xFFFFFF, kErasedFlash = 0xFFFFFF, kErasedEeprom = 0xFFFF;
    Machine& m = *machine_;
    const DeviceInfo& device = m.device;
    std::map<std::uint32_t, std::uint32_t> wanted;
    for (const ProgramWord& word : words)
        wanted[word.address & ~1u] = word.word & kWordMask;
    const auto write = [&](std::uint32_t start, std::size_t count, auto erased) {
        for (std::size_t i = 0; i < count; ++i) {
            const auto address = start + 2 * static_cast<std::uint32_t>(i);
            const auto found = wanted.find(address);
            const std::uint32_t word = found == wanted.end() ? erased(i) : found->second;
            if (read_program(m, address) != word) write_program(m, address, word);
        }
    };
    const std::vector<std::uint32_t> configuration = erased_configuration(device);
    write(0, device.flash_end / 2, [](std::size_t) { return kErasedFlash; });
    write(device.eeprom_start, m.eeprom.size(), [](std::size_t) { return kErasedEeprom; });
    write(device.config_start, m.config.size(), [&](std::size_t i) { return configuration[i]; });
    write(device.unit_id_start, m.unit_id.size(), [](std::size_t) { return kErasedFlash; });
}

std::uint32_t Core::program(std::uint32_t address) const {
    return read_program(*machine_, address);
}
bool Core::poke_program(std::uint32_t address, std::uint32_t word) {
    return write_program(*machine_, address & ~1u, word);
}
std::uint16_t Core::config(std::uint32_t address) const {
    return static_cast<std::uint16_t>(read_program(*machine_, address));
}

void Core::reset(ResetCause cause) {
    machine_->fault_pc = pc();
    perform_reset(*machine_, cause);
}
Core::Outcome Core::run(Cycle until) {
    return run_until(*machine_, until);
}
void Core::hold_before(Cycle from, const RegisterSet* registers) {
    machine_->gate = {from, registers, false};
}
bool Core::held_back() const {
    return machine_->gate.held;
}
void Core::end_run() {
    machine_->end_requested = true;
    machine_->limit = 0;
}
void Core::step() {
    run_until(*machine_, machine_->st.cycle + 1);
}
void Core::set_stops(std::span<const std::uint32_t> addresses) {
    Machine& m = *machine_;
    for (const std::uint32_t pc : m.stops) {
        if (m.program_undo.on()) m.program_undo.note_operation(m, pc >> 1);
        m.code[pc >> 1].marks &= static_cast<std::uint8_t>(~kStop);
        invalidate(m, pc);
    }
    m.stops.clear();
    for (const std::uint32_t pc : addresses) {
        if (pc >= m.device.flash_end) continue;
        m.stops.push_back(pc & ~1u);
        dspic::mark(m, pc, kStop);
    }
    if (m.pass_pc && std::find(m.stops.begin(), m.stops.end(), *m.pass_pc) == m.stops.end())
        m.pass_pc.reset();
}
void Core::set_skip_idle(bool on) {
    machine_->skip_idle = on;
}
void Core::set_translate(bool on) {
    machine_->translated.on = on;
}
void Core::set_errata(const Errata& errata) {
    machine_->daw_clears_carry = errata.has(Erratum::DawCarry);
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
    m.ram_words = instrument && accesses ? std::uint16_t{0} : static_cast<std::uint16_t>(m.ram_store.size());
}
void Core::stall_until(Cycle cycle) {
    machine_->stall_end = std::max(machine_->stall_end, cycle);
    machine_->limit = 0;
}

void Core::hold(bool on) {
    machine_->held = on;
    machine_->limit = 0;
    schedule_watchdog(*machine_);
}
void Core::request_reset(ResetCause cause) {
    dspic::request_reset(*machine_, cause);
}

void Core::doze_changed() {
    dspic::doze_changed(*machine_);
}
Cycle Core::cpu_cycle() const {
    return machine_->doze.ratio;
}

Cycle Core::cycle() const {
    return machine_->st.cycle;
}
const Cycle& Core::cycle_counter() const {
    return machine_->st.cycle;
}
std::uint32_t Core::pc() const {
    return machine_->pc_of(machine_->current);
}
const FastWork& Core::fast_work() const {
    return machine_->skip->work;
}

std::uint64_t Core::instructions() const {
    return machine_->instructions;
}
PowerMode Core::power_mode() const {
    return machine_->mode;
}
int Core::cpu_level() const {
    return dspic::cpu_level(*machine_);
}
const DeviceInfo& Core::device() const {
    return machine_->device;
}
std::optional<Core::BusyLoop> Core::busy_loop() const {
    int level = 0;
    const WaitWatch::Stay* stay = present_stay(*machine_, level);
    if (stay == nullptr || !stay->finding) return std::nullopt;
    return BusyLoop{stay->since, level, *stay->finding};
}
std::span<const MissingPoll> Core::missing_polls() const {
    return machine_->waits.polls;
}

CoreState Core::state() const {
    CoreState copy = machine_->st;
    copy.pc = pc();
    return copy;
}
void Core::set_state(const CoreState& state) {
    Machine& m = *machine_;
    m.st = state;
    m.current = at(m, state.pc);
    m.watch = 0;  // every register counts as written
    m.limit = 0;
    m.stall_end = 0;
    if (m.mode != PowerMode::Run) leave_power_save(m);
    if (m.st.sr & sr::DA) dspic::mark(m, m.st.loop.doend, kLoopEnd);
    update_pointer_rules(m);
    m.eligible = false;
    reconsider(m, m.st.cycle);
}
std::uint16_t Core::w(int index) const {
    return get_w(*machine_, index);
}
void Core::set_w(int index, std::uint16_t value) {
    dspic::set_w(*machine_, index, value);
    machine_->watch &= ~(0x10000u << index);
}
void Core::set_pc(std::uint32_t pc) {
    machine_->current = at(*machine_, pc & kProgramSpace);
    if (machine_->pass_pc != (pc & kProgramSpace))
        machine_->pass_pc.reset();  // the stop reported there is left
}
std::uint16_t Core::read_data(std::uint16_t address) {
    return read16(*machine_, address & 0xFFFE);
}
void Core::write_data(std::uint16_t address, std::uint16_t value) {
    write16(*machine_, address & 0xFFFE, value);
}
std::span<std::uint16_t> Core::ram() {
    return machine_->ram_store;
}

void Core::set_reset_hook(std::function<void(ResetCause)> hook) {
    machine_->reset_hook = std::move(hook);
}
void Core::set_power_hook(std::function<void(PowerMode)> hook) {
    machine_->power_hook = std::move(hook);
}
void Core::set_rcon_hook(std::function<void()> hook) {
    machine_->rcon_hook = std::move(hook);
}
void Core::set_cycle_rate(double hertz) {
    machine_->cycle_rate = hertz;
    note_rate(*machine_);
    schedule_watchdog(*machine_);
}
void Core::set_wake_time(double seconds) {
    machine_->wake_seconds = seconds;
}
CoreObserver& Core::observer() {
    return machine_->observer;
}

}  // namespace puckloop::dspic
