#pragma once
// Range and bearing between two boards as a receiver's host sees it, written from the effects sheet, 46-55,
// and the published medians of received strength. With every knob at rest: those medians and spreads at their
// nine distances, a bearing with a little noise, every message received.

#include "base/random.h"

#include <array>
#include <cstddef>

namespace puckloop::gap::selftest {

inline constexpr std::size_t kReceivers = 12;
inline constexpr std::array<double, 9> kStrengthDistances{0,    0.02, 0.05, 0.10, 0.15,
                                                          0.30, 0.45, 0.60, 0.80};  // m

struct RabKnobs {
    std::array<double, kReceivers> gain{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};  // [46] of a receiver
    double more_spread = 0.0;     // [47] noise of ln strength grows by this share
    double far_floor = 0.0;       // [48] counts below which no strength falls
    double saturation = 4095;     // [49] counts
    double reflected = 0.0;       // [51] probability that another path wins
    double reflected_loss = 1.0;  // [51] ln strength lost on it
    double collisions = 0.0;      // [52] 1 = senders that know nothing of each other
    double loss = 0.0;            // [53] probability, at any distance
    double poll_rate = 1e9;       // [54] messages a second that the host fetches
    double beat = 0.0;            // [55] share of each beat of the two clocks in which frames are lost
    double beat_period = 25.0;    // [55] s
    double sector = 0.0;          // unknown: ln strength lost by senders on the left
    double wander = 0.0;          // unknown: rad by which bearings swing, twice a turn
    double fading = 0.0;          // unknown: ln strength, swinging with time
};

/// One message.
struct Sending {
    double t, distance, bearing;
    std::size_t receiver;  ///< 0..11, nearest to the bearing
    int senders;
    double frame_time, send_period, arrival_rate;
    double beat_begun = 0.0;  ///< s before t = 0 that the two clocks' beat began
};

struct Hearing {
    bool received;
    double light;     ///< counts that would be read below the rail, without noise
    double strength;  ///< counts, without noise
    double bearing;   ///< rad, without noise
};

Hearing hear(const RabKnobs& knobs, const Sending& sending, RandomStream& chance);

/// Standard deviation of ln strength at this distance with every knob at rest.
double strength_spread(double distance);
/// Direction of a receiver, rad.
double receiver_direction(std::size_t receiver);

}  // namespace puckloop::gap::selftest
