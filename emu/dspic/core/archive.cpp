// What a core remembers, listed once for saving and loading (base/states/archive.h).

#include "emu/dspic/core/core.h"
#include "emu/dspic/fast/loop_undo.h"
#include "emu/dspic/machine/machine.h"
#include "emu/dspic/waits/wait_watch.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

namespace puckloop::dspic {

namespace {

constexpr std::uint32_t kWordMask = 0xFFFFFF;
constexpr Cycle kLongestExtra = 100;  ///< cycles that PSV reads of one instruction add, generously

constexpr Cycle kSlowest = 128;  ///< DOZE = 111

/// Words up to the last one that is not 0. Looking for it costs a fraction of copying what no program uses.
std::size_t used_words(std::span<const std::uint16_t> ram) {
    static constexpr std::array<std::uint16_t, 512> kZeros{};
    std::size_t end = ram.size();
    for (const std::size_t piece : {kZeros.size(), std::size_t{32}})
        while (end >= piece &&
               std::memcmp(ram.data() + end - piece, kZeros.data(), piece * sizeof(std::uint16_t)) == 0)
            end -= piece;
    return end;
}

/// The rest of RAM is 0.
template <class Archive>
void list_used_ram(Archive& archive, std::vector<std::uint16_t>& ram) {
    const std::size_t used_now = used_words(ram);
    std::size_t used = used_now;
    archive(used);
    std::span<std::uint16_t> words(ram.data(), used);
    archive.fixed(words);
    if constexpr (Archive::kLoads)
        if (used < used_now) std::fill(ram.data() + used, ram.data() + used_now, std::uint16_t{0});
}

template <class Archive>
void list(Archive& archive, Machine& m) {
    archive(m.st, m.watch, m.instructions);
    archive(m.eligible, m.since, m.disi_waits, m.fault_pc);
    bool resets = m.reset_request.has_value();
    ResetCause cause = m.reset_request.value_or(ResetCause::PowerOn);
    archive(resets);
    archive.bounded(cause, ResetCause::PowerOn, ResetCause::IllegalOpcode);
    if constexpr (Archive::kLoads) m.reset_request = resets ? std::optional(cause) : std::nullopt;
    archive(m.repeat_first, m.repeat_edge);
    archive.bounded(m.late, 0, kLongestExtra);
    archive.bounded(m.mode, PowerMode::Run, PowerMode::Sleep);
    archive(m.stall_end, m.held, m.wake_seconds, m.wake_end);
    archive.bounded(m.cycle_rate, 0.0, 1e10);
    archive(m.watchdog_cleared, m.doze.on, m.doze.recovers);
    archive.bounded(m.doze.ratio, 1, kSlowest);
    archive.bounded(m.doze.remaining_cycles, 0, kLongestExtra);
    archive(m.nvm.address, m.nvm.key_step);
    archive.fixed(m.nvm.latch);
    if constexpr (!Archive::kRaw) {  // see ProgramUndo
        std::vector<std::uint32_t> words(m.program.begin(), m.program.end());
        archive.fixed(words);
        if constexpr (Archive::kLoads)
            std::transform(words.begin(), words.end(), m.program.begin(),
                           [](std::uint32_t word) { return word & kWordMask; });
        archive.fixed(m.eeprom);
        archive.fixed(m.config);
        archive.fixed(m.unit_id);
    }
    if constexpr (Archive::kRaw)
        list_used_ram(archive, m.ram_store);
    else
        archive.fixed(m.ram_store);
    archive.grows(m.warned);
}

/// Where the program waits: operations by their addresses.
template <class Archive>
void list_waits(Archive& archive, Machine& m) {
    const std::uint32_t last_word = m.code_words - 1;
    const auto operation = [&](const Op*& op) {
        if constexpr (Archive::kRaw) return archive(op);
        std::uint32_t index = op ? static_cast<std::uint32_t>(op - m.code) : 0;
        archive.bounded(index, 0, last_word);
        if constexpr (Archive::kLoads) op = m.code + index;
    };
    WaitWatch& waits = m.waits;
    archive.bounded(waits.level, 0, static_cast<int>(waits.stays.size()) - 1);
    for (WaitWatch::Stay& stay : waits.stays) {
        bool there = stay.branch != nullptr;
        archive(there);
        if constexpr (Archive::kLoads)
            if (!there) stay.branch = nullptr;
        if (!there) continue;
        operation(stay.branch);
        operation(stay.head);
        archive(stay.stack, stay.since, stay.last, stay.next_look, stay.finding);
        if (stay.finding)
            for (const LoopCondition& condition : stay.finding->conditions)
                archive.check(condition.address % 2 == 0, "a word at an odd address");
    }
    archive.grows(waits.polls);
    if constexpr (Archive::kRaw) return;
    for (const MissingPoll& poll : waits.polls)
        archive.check(m.sfr.info(poll.condition.address & 0x7FE) != nullptr &&
                          poll.condition.address < 2 * SfrSpace::kWords,
                      "a poll of no register");
}

/// For a checkpoint: with what follows from the rest, instead of finding it anew.
template <class Archive>
void list_raw(Archive& archive, Machine& m) {
    list(archive, m);
    archive(m.current, m.outside_pc, m.special, m.stack_span, m.pass_pc, m.stops);
    list_waits(archive, m);
}

}  // namespace

void Core::state(StateWriter& archive) const {
    std::uint32_t pc = machine_->pc_of(machine_->current);
    archive(pc);
    list(archive, *machine_);
    list_waits(archive, *machine_);
    archive(machine_->pass_pc);
}

void Core::state(StateReader& archive) {
    Machine& m = *machine_;
    std::uint32_t pc = 0;
    archive(pc);
    list(archive, m);
    renew_code(m);
    m.current = at(m, pc & kProgramSpace);
    m.limit = 0;
    m.stopped = m.end_requested = false;
    // Where a loop ends the operation carries a mark: the present loop and the one in the shadow.
    dspic::mark(m, m.st.loop.doend, kLoopEnd);
    dspic::mark(m, m.st.loop_shadow.doend, kLoopEnd);
    update_pointer_rules(m);
    note_rate(m);
    list_waits(archive, m);  // whatever changes code forgets them
    archive(m.pass_pc);
    if (m.pass_pc && std::find(m.stops.begin(), m.stops.end(), *m.pass_pc) == m.stops.end())
        m.pass_pc.reset();
}

void Core::state(CheckpointWriter& archive) const {
    list_raw(archive, *machine_);
}

void Core::state(CheckpointReader& archive) {
    Machine& m = *machine_;
    list_raw(archive, m);
    note_rate(m);
    m.limit = 0;
    m.stopped = m.end_requested = false;
}

void Core::mark() {
    machine_->program_undo.begin();
    machine_->loop_undo->begin(*machine_);
}

void Core::rewind() {
    machine_->program_undo.rewind(*machine_);
    machine_->loop_undo->rewind(*machine_);
}

void Core::settle() {
    machine_->program_undo.end();
    machine_->loop_undo->end();
}

}  // namespace puckloop::dspic
