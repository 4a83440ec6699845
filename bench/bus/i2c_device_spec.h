#pragma once
// What the user wants on the bus of a target that is an I2C master: `ground`, `turret`, `lsm330`,
// `rab=IMAGE`, each but the LSM330 with an address if it is not the usual one (`ground@0x61`).

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::exec {

struct I2cDeviceSpec {
    enum class Kind : std::uint8_t { Ground, Turret, Lsm330, Rab };
    Kind kind = Kind::Ground;
    /// 7 bits. Of a board: it hears this one only; without it its firmware decides.
    std::optional<std::uint8_t> address;
    std::string image;  ///< of Rab: its firmware's file
};

/// `texts` as the command line gave them. Throws InputError for anything else, for a device named
/// twice and for two at one address.
std::vector<I2cDeviceSpec> parse_i2c_devices(const std::vector<std::string>& texts);

}  // namespace puckloop::exec
