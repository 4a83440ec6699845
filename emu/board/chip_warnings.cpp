#include "emu/board/chip_warnings.h"

#include "base/text/times_text.h"

#include "emu/image/code_places.h"

#include <fmt/format.h>

namespace puckloop::board {

namespace {

constexpr std::size_t kFewAddresses = 4;

std::string loop_text(std::uint32_t first, std::uint32_t last) {
    return first == last ? fmt::format("0x{:04x}", first) : fmt::format("0x{:04x}..0x{:04x}", first, last);
}

/// Cycles before a change of clock cannot be turned into times any more: a chip that was switched reports
/// later.
double seconds(const dspic::Chip& chip, dspic::Cycle cycle) {
    return cosim::to_seconds(chip.clock().time_of(cycle));
}

/// "pc 0x01f2", with symbol and source line where the image has them: "pc 0x01f2 in main+0x12 (main.c:12)".
std::string place(const dspic::Chip& chip, std::uint32_t pc) {
    return fmt::format("pc 0x{:04x}{}", pc, chip.places().text(pc));
}

/// Traps, and resets that no program asks for: the first of each with its place.
void add_crashes(const dspic::Chip& chip, const dspic::ChipReport& report, std::vector<std::string>& lines) {
    if (!report.traps.empty()) {
        const dspic::TrapRecord& first = report.traps.front();
        lines.push_back(fmt::format("took the {} trap {}, first at {} ({:.6f} s)", first.name,
                                    times_text(report.traps.size()), place(chip, first.pc),
                                    seconds(chip, first.cycle)));
    }
    const dspic::ResetRecord* first = nullptr;
    std::uint64_t times = 0;
    for (const dspic::ResetRecord& reset : report.resets) {
        if (reset.cause != "WDTO" && reset.cause != "IOPUWR" && reset.cause != "TRAPR") continue;
        if (first == nullptr) first = &reset;
        ++times;
    }
    if (first != nullptr)
        lines.push_back(fmt::format("crashed into a reset ({}) {}, first at {} ({:.6f} s)", first->cause,
                                    times_text(times), place(chip, first->pc), seconds(chip, first->cycle)));
}

}  // namespace

std::optional<std::string> waiting_text(const dspic::Chip& chip,
                                        const std::optional<dspic::WaitReport>& wait) {
    if (!wait) return std::nullopt;
    const double length = static_cast<double>(chip.cycle() - wait->since) / chip.clock().hertz();
    if (wait->asleep) return fmt::format("has slept for {:.1f} s {}", length, wait->text);
    return fmt::format("has run {:.1f} s in the loop {} {}", length, loop_text(wait->first, wait->last),
                       wait->text);
}

std::vector<std::string> chip_warnings(const dspic::Chip& chip) {
    std::vector<std::string> lines;
    const std::optional<dspic::WaitReport> wait = chip.waiting();
    if (wait && wait->hung) lines.push_back(*waiting_text(chip, wait));
    const dspic::ChipReport report = chip.report();
    add_crashes(chip, report, lines);
    for (const dspic::MissingBitReport& poll : report.missing_bits) {
        if (wait && wait->hung && wait->first == poll.first && wait->last == poll.last) continue;
        lines.push_back(fmt::format("waited in the loop {} for {}, which no model drives ({:.6f} s)",
                                    loop_text(poll.first, poll.last), poll.bits, seconds(chip, poll.cycle)));
    }
    for (const dspic::UnmodelledTouch& touch : report.unmodelled)
        lines.push_back(fmt::format(
            "{} {} at {} ({:.6f} s)", touch.write ? "wrote" : "read",
            touch.name.empty() ? fmt::format("0x{:04x}, where the chip has no register,", touch.address)
                               : touch.name + ", which is not modelled,",
            place(chip, touch.pc), seconds(chip, touch.cycle)));
    // A program that looks for boards asks at every address.
    if (report.refused_addresses.size() > kFewAddresses) {
        std::uint64_t times = 0;
        for (const dspic::RefusedAddress& refused : report.refused_addresses)
            times += refused.times;
        lines.push_back(fmt::format("addressed {} addresses on I2C, {}, and nobody acknowledged",
                                    report.refused_addresses.size(), times_text(times)));
    } else {
        for (const dspic::RefusedAddress& refused : report.refused_addresses)
            lines.push_back(fmt::format("addressed 0x{:02x} on I2C {}, and nobody acknowledged",
                                        refused.address, times_text(refused.times)));
    }
    for (const dspic::ChipWarning& warning : report.warnings)
        lines.push_back(fmt::format("{} ({})", warning.text, place(chip, warning.pc)));
    return lines;
}

}  // namespace puckloop::board
