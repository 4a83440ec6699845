#include "emu/dspic/device.h"

#include <algorithm>
#include <cctype>

namespace puckloop::dspic {

const DeviceInfo* find_device(std::string_view name) {
    const auto same = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
    };
    for (const DeviceInfo* device : {&dspic30f6014a()})
        if (std::ranges::equal(device->name, name, same)) return device;
    return nullptr;
}

}  // namespace puckloop::dspic
