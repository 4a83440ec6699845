// What a core remembers, listed once for saving and loading (base/states/archive.h). Decoded operations and
// what is known about loops are found again.

#include "emu/avr/core/core.h"
#include "emu/avr/machine/machine.h"

#include <algorithm>

#include "base/states/archive.h"
#include "base/states/checkpoint.h"

namespace puckloop::avr {

namespace {

template <class Archive>
void list(Archive& archive, Machine& m) {
    std::uint16_t pc = m.pc_of(m.current);
    archive(m.sreg, m.sp, m.rampz, m.cycle, m.instructions, pc);
    if constexpr (Archive::kLoads) m.current = m.code + pc;
    archive(m.now, m.hold_at, m.stall_end, m.asleep, m.wakers, m.start_up, m.started);
    archive.bounded(m.last_vector, -1, 63);
    bool resets = m.reset_request.has_value();
    ResetCause cause = m.reset_request.value_or(ResetCause::PowerOn);
    archive(resets);
    archive.bounded(cause, ResetCause::PowerOn, ResetCause::Watchdog);
    if constexpr (Archive::kLoads) m.reset_request = resets ? std::optional(cause) : std::nullopt;
    if constexpr (!Archive::kRaw) archive.fixed(m.program);  // see Core::mark()
    constexpr std::size_t kRegisters = 32;
    std::span<std::uint8_t> registers(m.data.data(), kRegisters);
    std::span<std::uint8_t> ram(m.data.data() + m.ram_start, m.device.ram_bytes);
    for (std::span<std::uint8_t>* bytes : {&registers, &ram}) {
        if constexpr (Archive::kRaw)
            archive.fixed(*bytes);
        else
            for (std::uint8_t& byte : *bytes)
                archive(byte);
    }
    if constexpr (Archive::kRaw)
        archive.grows(m.warned);
    else
        archive(m.warned);
    std::vector<std::uint16_t> stops = m.stops;  // a bench's, but what a mark is set over may change them
    if constexpr (Archive::kRaw) archive(stops);
    archive(m.pass_pc);
    if constexpr (Archive::kLoads) {
        if (stops != m.stops) {
            m.stops.swap(stops);
            for (const std::vector<std::uint16_t>& list : {stops, m.stops})
                for (const std::uint16_t stop : list)
                    forget(m, stop);
        }
        const bool stops_there =
            m.pass_pc && std::find(m.stops.begin(), m.stops.end(), *m.pass_pc) != m.stops.end();
        if (!stops_there) m.pass_pc.reset();
    }
}

}  // namespace

void Core::state(StateWriter& archive) const {
    list(archive, *machine_);
}

void Core::state(StateReader& archive) {
    Machine& m = *machine_;
    list(archive, m);
    for (std::uint32_t i = 0; i < m.device.flash_words; ++i)
        forget(m, i);
    m.stopped = m.end_requested = false;
}

void Core::state(CheckpointWriter& archive) const {
    list(archive, *machine_);
}

void Core::state(CheckpointReader& archive) {
    Machine& m = *machine_;
    list(archive, m);
    m.limit = 0;
    m.stopped = m.end_requested = false;
}

void Core::mark() {
    machine_->program_undo.begin();
}

void Core::rewind() {
    machine_->program_undo.rewind(
        [this](std::uint32_t address, std::uint16_t word) { set_program(address, word); });
}

void Core::settle() {
    machine_->program_undo.end();
}

}  // namespace puckloop::avr
