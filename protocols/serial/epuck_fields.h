#pragma once
// Names of the fields of the records between Linux board and main board, by the places of their bytes.

#include "protocols/serial/epuck_serial.h"

#include <cstddef>
#include <string>

namespace puckloop::protocols {

enum class EpuckRecord { Session, Actuators, Sensors };

/// Bytes of a record; of the session's begin with the wake-up.
std::size_t size_of(EpuckRecord record);

/// "session", "actuators", "sensors".
const char* name_of(EpuckRecord record);

/// "proximity[3]", and " low" or " high" of a number of two bytes, " byte 2" of one of four. `byte` is less
/// than the record's size.
std::string field_at(EpuckRecord record, std::size_t byte);

}  // namespace puckloop::protocols
