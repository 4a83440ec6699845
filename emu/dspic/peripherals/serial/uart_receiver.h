#pragma once
// The receiver of a serial line that all chips share.

#include "emu/chip/uart_receiver.h"
#include "emu/dspic/machine/event_queue.h"

namespace puckloop::dspic {

using chip::UartReceiver;

}  // namespace puckloop::dspic
