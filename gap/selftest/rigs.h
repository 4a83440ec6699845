#pragma once
// The rigs, one a kind of experiment.

#include "gap/selftest/plain_accelerometer.h"
#include "gap/selftest/plain_ground.h"
#include "gap/selftest/plain_microphone.h"
#include "gap/selftest/plain_motion.h"
#include "gap/selftest/plain_proximity.h"
#include "gap/selftest/plain_rab.h"
#include "gap/selftest/plain_timing.h"
#include "gap/selftest/rig.h"

namespace puckloop::gap::selftest {

const Rig<MotionKnobs>& motion_rig();
const Rig<ProximityKnobs>& proximity_rig();
const Rig<RabKnobs>& rab_rig();
const Rig<MicrophoneKnobs>& microphone_rig();
const Rig<GroundKnobs>& ground_rig();
const Rig<AccelerometerKnobs>& accelerometer_rig();
const Rig<TimingKnobs>& timing_rig();

}  // namespace puckloop::gap::selftest
