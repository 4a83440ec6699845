#pragma once
// The timetable that all chips share; a Cycle is an instruction cycle (TCY) here.

#include "emu/chip/event_queue.h"

namespace puckloop::dspic {

using chip::Cycle;
using chip::EventQueue;
using chip::kNoCycle;

}  // namespace puckloop::dspic
