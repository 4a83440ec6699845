// What a core remembers, listed once for saving and loading (base/archive.h). Decoded operations and what is
// known about loops are found anew.

#include "emu/avr/core/machine.h"

#include "base/archive.h"

namespace puckloop::avr {

namespace {

template <class Archive>
void list(Archive& archive, Machine& m) {
    std::uint16_t pc = m.pc_of(m.current);
    archive(m.sreg, m.sp, m.rampz, m.cycle, m.instructions, pc);
    if constexpr (Archive::kLoads) m.current = m.code + pc;
    archive(m.now, m.hold_at, m.stall_end, m.asleep);
    bool resets = m.reset_request.has_value();
    ResetCause cause = m.reset_request.value_or(ResetCause::PowerOn);
    archive(resets);
    archive.bounded(cause, ResetCause::PowerOn, ResetCause::Watchdog);
    if constexpr (Archive::kLoads) m.reset_request = resets ? std::optional(cause) : std::nullopt;
    archive.fixed(m.program);
    for (std::uint32_t i = 0; i < 32; ++i)
        archive(m.data[i]);
    for (std::uint32_t i = 0; i < m.ram_bytes; ++i)
        archive(m.data[m.ram_start + i]);
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
    m.pass_pc.reset();
}

}  // namespace puckloop::avr
