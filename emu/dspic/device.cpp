#include "emu/dspic/device.h"

namespace puckloop::dspic {

namespace {
constexpr std::string_view kTraps[kTrapVectors] = {"Reserved0",  "OscillatorFail", "AddressError",
                                                   "StackError", "MathError",      "DmacError",
                                                   "Reserved6",  "Reserved7"};
constexpr std::string_view kReserved = "Reserved";
}  // namespace

std::optional<int> DeviceInfo::irq(std::string_view irq_name) const {
    for (const IrqName& source : irqs)
        if (source.name == irq_name) return source.irq;
    return std::nullopt;
}

std::string_view DeviceInfo::vector_name(int vector) const {
    if (vector >= 0 && vector < kTrapVectors) return kTraps[vector];
    for (const IrqName& source : irqs)
        if (source.irq + kTrapVectors == vector) return source.name;
    return kReserved;
}

std::span<const DeviceInfo> devices() {
    return {&dspic30f6014a(), 1};
}

const DeviceInfo* find_device(std::string_view name) {
    for (const DeviceInfo& device : devices())
        if (device.name == name) return &device;
    return nullptr;
}

}  // namespace puckloop::dspic
