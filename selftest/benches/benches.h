#pragma once
// The rigs and what can be hidden in them, one a kind of experiment (bench_<kind>.cpp).

#include "selftest/benches/rig.h"
#include "selftest/plain/plain_accelerometer.h"
#include "selftest/plain/plain_ground.h"
#include "selftest/plain/plain_microphone.h"
#include "selftest/plain/plain_motion.h"
#include "selftest/plain/plain_proximity.h"
#include "selftest/plain/plain_rab.h"
#include "selftest/plain/plain_timing.h"

#include <memory>

namespace puckloop::gap::selftest {

const Rig<MotionKnobs>& motion_rig();
const Rig<ProximityKnobs>& proximity_rig();
const Rig<RabKnobs>& rab_rig();
const Rig<MicrophoneKnobs>& microphone_rig();
const Rig<GroundKnobs>& ground_rig();
const Rig<AccelerometerKnobs>& accelerometer_rig();
const Rig<TimingKnobs>& timing_rig();

std::unique_ptr<Bench> motion_bench();
std::unique_ptr<Bench> proximity_bench();
std::unique_ptr<Bench> rab_bench();
std::unique_ptr<Bench> microphone_bench();
std::unique_ptr<Bench> ground_bench();
std::unique_ptr<Bench> accelerometer_bench();
std::unique_ptr<Bench> timing_bench();

}  // namespace puckloop::gap::selftest
