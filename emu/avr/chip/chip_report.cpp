// What is reported of an ATmega1284P: what its program waits for in vain, and what came about.

#include "emu/avr/chip/chip_parts.h"

#include <fmt/format.h>

namespace puckloop::avr {

std::optional<std::string> Chip::hang() const {
    const Parts& p = *parts_;
    constexpr double kLong = 0.5;
    const auto seconds = [&](Cycle from) {
        return cosim::to_seconds(p.clock.time_of(p.core.cycle()) - p.clock.time_of(from));
    };
    const std::optional<WaitingLoop> loop = p.core.waiting();
    if (!loop || seconds(loop->since) < kLong) return std::nullopt;
    const bool masked = !(p.core.state().sreg & sreg::I);
    constexpr std::uint16_t kTwcr = 0xBC, kAdcsra = 0x7A;
    const RegisterInfo* polled = loop->polled ? p.io.info(loop->polled) : nullptr;
    std::string why;
    if (loop->polled == kTwcr && p.twi.idle())
        why = "reading TWCR, but the two-wire interface has nothing to do";
    else if (loop->polled == kAdcsra && !p.adc.converting())
        why = "reading ADCSRA, but no conversion is under way";
    else if (!polled && loop->reads_ram && masked)
        why = "reading RAM that only an interrupt could change, with interrupts off";
    else
        return std::nullopt;
    return fmt::format("has run {:.1f} s in the loop 0x{:04x}..0x{:04x} {}", seconds(loop->since),
                       2u * loop->head, 2u * loop->branch, why);
}

ChipReport Chip::report() const {
    ChipReport report = parts_->report;
    report.instructions = parts_->core.instructions();
    report.cycles = parts_->core.cycle();
    report.skipped = parts_->core.skipped();
    report.refused_addresses = parts_->twi.refused();
    return report;
}

std::optional<std::string> refused_text(const ChipReport& report) {
    const auto& addresses = report.refused_addresses;
    constexpr std::size_t kFew = 4;
    if (addresses.empty()) return std::nullopt;
    if (addresses.size() > kFew)
        return fmt::format("addressed {} addresses on the two-wire bus that nobody acknowledged",
                           addresses.size());
    return fmt::format("addressed 0x{:02x} on the two-wire bus, and nobody acknowledged",
                       fmt::join(addresses, ", 0x"));
}

}  // namespace puckloop::avr
