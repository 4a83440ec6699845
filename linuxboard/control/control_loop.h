#pragma once
// Sense, control, act, ten times a second, for a given time or until interrupted.

#include "linuxboard/control/behaviours/behaviour.h"
#include "linuxboard/control/session.h"

#include <functional>
#include <optional>

namespace puckloop::control {

struct LoopSettings {
    double period = 0.1;     ///< s
    double duration = 0;     ///< s, 0: until interrupted
    double start_wait = 60;  ///< s to wait for the PIC at the start (the original needs 40 s after power-up)
    double give_up = 60;     ///< s without the PIC in mid-session before the run fails
    int word = -1;           ///< 0..255: sent by IRcom when the behaviour has none of its own
    double word_every = 0;   ///< s between two of those, 0: every step
    double stale_after = 0.3;  ///< s: the robot stands still while its newest sensors are older
    /// Exchanges of records in a step, evenly spread, 1 to kMostExchanges: a speed that was garbled on its
    /// way is driven until the next one, and of three or more the sensors' medians count (record_vote.h).
    int exchanges = 1;
};

/// One takes some 13 ms.
inline constexpr int kMostExchanges = 5;

/// What else the robot carries; empty functions for what it does not.
struct Surroundings {
    std::function<std::optional<std::array<double, 3>>()> ground;
    std::function<std::vector<Neighbour>()> neighbours;
    std::function<void(std::uint32_t)> say;              ///< to the neighbours, from now on
    std::function<std::vector<ColouredSpot>()> spots{};  ///< before the omnidirectional camera
    std::function<void(const InfraredWord&)> heard{};    ///< of every word that came
};

/// What the behaviour sees of a sensor record, and what the PIC gets of its requests.
Sensors to_sensors(const protocols::EpuckSensors& record);
protocols::EpuckActuators to_record(const Actuators& actuators);

/// Runs the whole session: start, duration/period actuator records, the last with the wheels at rest, end
/// record. False when the PIC could not be reached. Throws LineError.
bool run_control_loop(Session& session, Transport& transport, Behaviour& behaviour,
                      const Surroundings& surroundings, const std::function<bool()>& interrupted,
                      const LoopSettings& settings);

}  // namespace puckloop::control
