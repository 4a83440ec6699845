#pragma once

#include "emu/chip/uart_counters.h"

namespace puckloop::dspic {

using chip::UartCounters;

}  // namespace puckloop::dspic
