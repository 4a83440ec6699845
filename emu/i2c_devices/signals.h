#pragma once
// The named signals of the devices on a robot's I2C bus: what the world does to ground sensor and LSM330, and
// what the RGB turret shows. Ids on the bus node's `world` port are indexes into signals().

#include "cosim/core/signal_info.h"

#include <cstdint>
#include <span>

namespace puckloop::i2c_devices {

inline constexpr std::uint16_t kGroundReflected =
    0;                                              ///< 3: "ground0" left, "ground1" centre, "ground2" right
inline constexpr std::uint16_t kGroundAmbient = 3;  ///< 3: "ground_ambient0" .. "ground_ambient2"
inline constexpr std::uint16_t kRgb = 6;            ///< 9: "rgb0_red", "rgb0_green", ... "rgb2_blue"
inline constexpr std::uint16_t kAcceleration = 15;  ///< 3: "lsm330_acc_x" (forward), "_y" (left), "_z" (up)
inline constexpr std::uint16_t kTurnRate = 18;      ///< 3: "lsm330_rate_x" .. "_z", about the same axes
inline constexpr std::uint16_t kSignalCount = 21;

std::span<const cosim::SignalInfo> signals();

}  // namespace puckloop::i2c_devices
