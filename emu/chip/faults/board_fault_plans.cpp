// What the parameters of a board's faults mean for its chip and its firmware.

#include "emu/chip/faults/board_faults.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace puckloop::chip {

namespace {

using cosim::CarriedFault;
using cosim::FaultSpec;

/// In the order of BoardFaults::Kind.
constexpr std::array<std::string_view, 17> kKinds{
    "reset",           "hang",         "brown_out",     "flip",           "interrupt",     "flash",
    "clock",           "sag",          "battery",       "ambient_burst",  "phase_open",    "wheel_stall",
    "foreign_carrier", "emitter_dead", "receiver_dead", "lost_interrupt", "late_interrupt"};

[[noreturn]] void refuse(const FaultSpec& spec, const std::string& what, const std::string& expected) {
    throw InputError("", fmt::format("fault {} on {}", spec.name, spec.node), what, expected);
}

/// A number as the firmware's listing has it: decimal or 0x.
std::optional<std::uint32_t> number_of(const std::string& text) {
    try {
        std::size_t end = 0;
        const unsigned long value = std::stoul(text, &end, 0);
        if (end == text.size() && text[0] != '-' && value <= 0xFFFFFF)
            return static_cast<std::uint32_t>(value);
    } catch (const std::exception&) {
    }
    return std::nullopt;
}

}  // namespace

std::optional<BoardFaults::Kind> BoardFaults::kind_of(std::string_view name) {
    const auto* const found = std::find(kKinds.begin(), kKinds.end(), name);
    if (found == kKinds.end()) return std::nullopt;
    return static_cast<Kind>(found - kKinds.begin());
}

BoardFaults::Plan BoardFaults::plan_of(const CarriedFault& fault, const Symbols& symbols) const {
    const FaultSpec& spec = fault.spec;
    const std::optional<Kind> kind = kind_of(spec.kind);
    if (!kind) refuse(spec, fmt::format("a board knows no {}", spec.kind), "another kind");
    Plan plan;
    plan.kind = *kind;
    plan.holds = plan.kind >= Kind::Clock && plan.kind <= Kind::ForeignCarrier;
    plan.candidates = plan.kind > Kind::ForeignCarrier;
    if (const std::string pc = spec.parameters.text("pc"); !pc.empty()) {
        std::optional<std::uint32_t> address = symbols.code(pc);
        if (!address) address = number_of(pc);
        if (!address || chip_.bits({MemorySpace::Flash, *address}) == 0)
            refuse(spec, fmt::format("no program at pc = '{}'", pc),
                   "a function of the firmware, if its file has symbols, or an even address");
        plan.by_pc = true;
        plan.pc = *address;
    }
    if (plan.kind == Kind::Reset) {
        plan.cause = reset_cause_of_name(spec.parameters.text("cause", "mclr")).value_or(plan.cause);
        if (!chip_.knows(plan.cause))
            refuse(spec, fmt::format("this chip has no reset by {}", spec.parameters.text("cause")),
                   "power_on, brown_out, mclr or watchdog");
    }
    if (plan.kind == Kind::Interrupt || plan.kind == Kind::LostInterrupt ||
        plan.kind == Kind::LateInterrupt) {
        const std::string source = spec.parameters.text("vector");
        const std::optional<int> vector = chip_.vector(source);
        if (!vector)
            refuse(spec, fmt::format("no interrupt source '{}'", source),
                   "a name of the data sheet's vector table, such as U2RX or T1 of a dsPIC, USART0_RX of an "
                   "AVR");
        plan.vector = *vector;
    }
    if (plan.kind == Kind::Flip) plan_flip(plan, fault, symbols);
    if (plan.kind == Kind::Flash)
        chip_.read_image(spec.parameters.text("image"), spec.parameters.text("sha256"));
    return plan;
}

void BoardFaults::plan_flip(Plan& plan, const CarriedFault& fault, const Symbols& symbols) const {
    const FaultSpec& spec = fault.spec;
    plan.space = memory_space_of_name(spec.parameters.text("space", "ram")).value_or(MemorySpace::Ram);
    if (chip_.cells(plan.space) == 0) refuse(spec, "this chip has no such memory", "another space");
    const std::string symbol = spec.parameters.text("symbol");
    std::optional<std::uint32_t> address;
    if (spec.parameters.has("address"))
        address = static_cast<std::uint32_t>(spec.parameters.number("address"));
    if (!symbol.empty()) {
        if (plan.space == MemorySpace::Register) {
            plan.place = chip_.find_register(symbol);
            if (!plan.place)
                refuse(spec, fmt::format("no register '{}' that is modelled", symbol), "a data-sheet name");
        } else {
            const auto base = (plan.space == MemorySpace::Flash ? symbols.code : symbols.data)(symbol);
            if (!base)
                refuse(spec, fmt::format("no symbol '{}'", symbol),
                       "a name of the firmware's, if its file has symbols");
            address = *base + address.value_or(0);
        }
    }
    if (!plan.place && address) plan.place = MemoryPlace{plan.space, *address};
    if (plan.place && chip_.bits(*plan.place) == 0)
        refuse(spec,
               fmt::format("no cell of the {} at 0x{:X}", spec.parameters.text("space", "ram"),
                           plan.place->address),
               "an address that the chip has");
    if (!spec.parameters.has("bit")) return;
    plan.bit = static_cast<int>(spec.parameters.number("bit"));
    const std::uint32_t bits = plan.place ? chip_.bits(*plan.place) : chip_.bits(chip_.cell(plan.space, 0));
    if ((plan.place || plan.space != MemorySpace::Register) && !(bits >> plan.bit & 1))
        refuse(spec, fmt::format("no bit {} there", plan.bit), fmt::format("one of the bits 0x{:X}", bits));
}

}  // namespace puckloop::chip
