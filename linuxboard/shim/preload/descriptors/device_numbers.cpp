#include "linuxboard/shim/preload/descriptors/device_numbers.h"
#include "linuxboard/shim/preload/host/path.h"

#include "linuxboard/shim/preload/host/link.h"

#include <cstdlib>
#include <cstring>

namespace puckloop::shim {

namespace {
struct Names {
    const char* prefix;
    unsigned major;
    unsigned first;  ///< minor number of the one numbered 0
};
// Linux's Documentation/admin-guide/devices.txt; ttyO of omap-serial has a major number that the kernel
// draws.
constexpr Names kNames[] = {
    {"ttyS", 4, 64},     {"ttyUSB", 188, 0}, {"ttyACM", 166, 0}, {"ttyAMA", 204, 64},
    {"ttymxc", 207, 16}, {"ttyO", 249, 0},   {"rfcomm", 216, 0}, {"serial", 4, 64},
    {"i2c-", 89, 0},     {"video", 81, 0},   {"urandom", 1, 9},  {"random", 1, 8},
};
}  // namespace

namespace {

/// A name of the bus without a number has that of the first name.
const char* numbered_name(const char* name) {
    constexpr char kBus[] = "i2c-";
    constexpr std::size_t kSize = sizeof kBus - 1;
    if (std::strncmp(name, kBus, kSize) != 0 || (name[kSize] >= '0' && name[kSize] <= '9')) return name;
    for (const wire::DeviceName& device : page().devices)
        if (device.kind == wire::DeviceKind::I2c) return last_part(device.path);
    return name;
}
}  // namespace

dev_t device_number(const char* path) {
    const char* name = numbered_name(last_part(path));
    for (const Names& known : kNames) {
        const std::size_t size = std::strlen(known.prefix);
        if (std::strncmp(name, known.prefix, size) != 0) continue;
        return makedev(known.major, known.first + static_cast<unsigned>(std::atoi(name + size)));
    }
    return makedev(4, 64);
}

}  // namespace puckloop::shim
