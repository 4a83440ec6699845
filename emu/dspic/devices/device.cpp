#include "emu/dspic/devices/device.h"

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

std::span<const DeviceInfo* const> devices() {
    static const DeviceInfo* const known[] = {&dspic30f6014a(), &dspic33fj256gp710()};
    return known;
}

const DeviceInfo* find_device(std::string_view name) {
    for (const DeviceInfo* device : devices())
        if (device->name == name) return device;
    return nullptr;
}

std::string device_names() {
    std::string names;
    for (const DeviceInfo* device : devices()) {
        if (!names.empty()) names += ", ";
        names += device->name;
    }
    return names;
}

}  // namespace puckloop::dspic
