#include "emu/avr/chip/crash_text.h"

#include "base/text/times_text.h"

#include "emu/image/code_places.h"

#include <fmt/format.h>

namespace puckloop::avr {

std::string place_text(const Chip& chip, std::uint32_t pc) {
    return fmt::format("pc 0x{:05x}{}", pc, chip.places().text(pc));
}

std::optional<std::string> crash_text(const Chip& chip, const ChipReport& report) {
    const ResetRecord* first = nullptr;
    std::uint64_t times = 0;
    for (const ResetRecord& reset : report.resets) {
        if (reset.cause != ResetCause::Watchdog) continue;
        if (first == nullptr) first = &reset;
        ++times;
    }
    if (first == nullptr) return std::nullopt;
    return fmt::format("was reset by the watchdog {}, first at {} ({:.6f} s)", times_text(times),
                       place_text(chip, first->pc), cosim::to_seconds(chip.clock().time_of(first->cycle)));
}

}  // namespace puckloop::avr
