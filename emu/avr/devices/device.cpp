#include "emu/avr/devices/device.h"

#include <algorithm>
#include <stdexcept>

namespace puckloop::avr {

std::string_view DeviceInfo::vector_name(int number) const {
    const auto found =
        std::find_if(vectors.begin(), vectors.end(), [&](const VectorInfo& v) { return v.number == number; });
    return found == vectors.end() ? "?" : found->name;
}

int DeviceInfo::vector(std::string_view source) const {
    const auto found =
        std::find_if(vectors.begin(), vectors.end(), [&](const VectorInfo& v) { return v.name == source; });
    if (found == vectors.end()) throw std::out_of_range("no vector " + std::string(source));
    return found->number;
}

const DeviceInfo* find_device(std::string_view name) {
    return name == atmega1284p().name ? &atmega1284p() : nullptr;
}

std::string device_names() {
    return std::string(atmega1284p().name);
}

}  // namespace puckloop::avr
