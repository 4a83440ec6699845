#pragma once
// The serial line as a logic analyser at the main board's transmitter sees it: each answer's bytes, made by
// the board's own clock, timed by the analyser's. An experiment of kind timing; a run is one answer.

#include "tools/gap/emulate/record.h"

namespace puckloop::gap::emulate {

WrittenExperiment record_serial(const RecordOptions& options);

}  // namespace puckloop::gap::emulate
