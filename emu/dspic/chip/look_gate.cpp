#include "emu/dspic/chip/look_gate.h"

#include "emu/dspic/core/core.h"
#include "emu/dspic/devices/register_bits.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kADxCON1{"AD?CON1"};
constexpr RegisterBits kOSCCON{"OSCCON"};

/// Of the 33FJ: between two conversions DONE is set.
bool converts(std::uint16_t con1) {
    return (con1 & kADxCON1["ADON"]) && ((con1 & kADxCON1["SAMP"]) || !(con1 & kADxCON1["DONE"]));
}

}  // namespace

LookGate::LookGate(Chip& chip, std::span<const std::string_view> looks,
                   std::span<const std::string_view> modules)
    : inside_(chip.inside()) {
    const auto guard = [this](std::string_view name) -> const RegisterInfo* {
        const RegisterInfo* info = inside_.sfr.find(name);
        if (info) registers_.set(info->address / 2u);
        return info;
    };
    for (const std::string_view name : looks)
        guard(name);
    for (const std::string_view name : modules)
        if (const RegisterInfo* info = guard(name)) modules_.push_back({info->address, info->reset});
    // Another clock would put the gate elsewhere.
    for (const std::string_view name : {"OSCCON", "CLKDIV", "PLLFBD", "OSCTUN"})
        guard(name);
    oscillator_ = inside_.sfr.find("OSCCON")->address;
    for (const std::string_view name : {"AD1CON1", "AD2CON1"})
        if (const RegisterInfo* info = guard(name)) converters_.push_back(info->address);
}

bool LookGate::applies() const {
    const SfrSpace& sfr = inside_.sfr;
    return !(sfr.raw(oscillator_) & kOSCCON["OSWEN"]) &&
           std::all_of(modules_.begin(), modules_.end(),
                       [&](const Module& module) { return sfr.raw(module.address) == module.after_reset; }) &&
           std::none_of(converters_.begin(), converters_.end(),
                        [&](std::uint16_t address) { return converts(sfr.raw(address)); });
}

void LookGate::open(cosim::Time known) {
    inside_.core.hold_before(inside_.clock.first_cycle_at(known), &registers_);
}

void LookGate::lift() {
    inside_.core.hold_before(kNoCycle, nullptr);
}

bool LookGate::held() const {
    return inside_.core.held_back();
}

}  // namespace puckloop::dspic
