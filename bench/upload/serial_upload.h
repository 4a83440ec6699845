#pragma once
// An upload through a serial port, answer by answer: a pty of a paced run, or a real robot.

#include "bench/upload/boot_packets.h"

#include <functional>
#include <string>

namespace puckloop::tools {

/// Asks for the boot loader every 100 ms until it answers, at `baud` bits/s, for at most `patience` s, then
/// sends the packets; a row that came wrong is sent again, five times, each time from where the boot loader
/// begins a row for certain (boot_place.h). After 3 s without an answer the boot loader is asked for again.
/// `progress` gets the share that is through. Throws RunError: no port, nobody answers.
void upload(const std::string& port, const std::vector<BootPacket>& packets, double baud, double patience,
            const std::function<void(double)>& progress);

}  // namespace puckloop::tools
