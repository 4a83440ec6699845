#pragma once
// Range and bearing recorded on the emulator: pairs of boards with firmware on a stage that turns and parts
// them, infra-red medium between them, read over I2C as a robot does (reproductions/rab). Frames by all
// emitters at nine distances and by single emitters near by, each waited for; and at three rates, read by the
// robot's program at its own polls.

#include "selftest/emulate/record.h"

namespace puckloop::gap::emulate {

/// Of the robot only `parameters` (ir.*), `rab` and `rab_poll` count: the boards stand on the stage by
/// themselves.
WrittenExperiment record_rab(const RecordOptions& options);

/// Hardware number (1..12) of the receiver nearest to a direction (rad), by the drawing.
int nearest_receiver(double bearing);

}  // namespace puckloop::gap::emulate
