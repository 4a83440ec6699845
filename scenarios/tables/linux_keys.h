#pragma once
// The keys of a Linux program: [robot.linux], [coordinator], and an overlay's [linux].

#include "scenarios/description/scenario.h"
#include "scenarios/values/reader.h"

namespace puckloop::scenarios {

/// Program, host name, times, folder, signals and delays; what is absent stays as `board` has it. Throws
/// InputError with the line.
void read_program(Reader& reader, LinuxBoard& board);

/// `serial_devices` and `i2c_devices`. Throws InputError with the line.
void read_devices(Reader& reader, LinuxBoard& board);

/// Throws InputError if `name` in `key` is no file below /dev, or one that any Linux board has.
void check_device_name(Reader& reader, std::string_view key, const std::string& name,
                       std::string_view example);

/// Those that are absent leave `late` as it is.
void read_delays(Reader& reader, LinuxDelays& late);

}  // namespace puckloop::scenarios
