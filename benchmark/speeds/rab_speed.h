#pragma once
// How fast one range-and-bearing board runs with nothing at its ports.

#include <filesystem>

namespace puckloop::tools {

enum class RabWork {
    Idle,    ///< listens to silence
    Sending  ///< asked over UART2 to send 16 bits every 10 ms: on the air half of the time
};

/// Times real time, after the firmware's start-up, measured for about `wall_s` seconds. Throws InputError if
/// the image cannot be read.
double rab_board_speed(const std::filesystem::path& image, RabWork work, double wall_s);

}  // namespace puckloop::tools
