#include "linuxboard/control/control_loop.h"

#include "linuxboard/control/record_vote.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace puckloop::control {

using namespace protocols;

namespace {

constexpr double kDarkest = 4095;  // raw light value in the dark; the sensor gives less where it is brighter
constexpr double kLateTurn = 0.004;  // s: an exchange of a step that would begin later than this is left out
constexpr double kLastTry = 1.0;     // s to get the robot to rest when the last record went unanswered

std::int16_t to_steps(double mm_s) {
    const double clamped = std::clamp(mm_s, -kMaximumSpeed, kMaximumSpeed);
    return std::isfinite(mm_s) ? static_cast<std::int16_t>(std::lround(clamped / kMillimetresPerStep))
                               : std::int16_t{0};
}

/// Which of a session's words are new. The original firmware renews its fields only after a record that sends
/// a word; ours reports each word once.
class WordFilter {
  public:
    std::optional<InfraredWord> take(const EpuckSensors& record, bool sent) {
        const bool was = std::exchange(shown_, record.ircom_received != 0);
        if (!shown_ || (was && !sent)) return std::nullopt;
        return InfraredWord{record.ircom_data, std::remainder(double{record.ircom_bearing}, kTurn),
                            record.ircom_range};
    }

  private:
    static constexpr double kTurn = 2 * std::numbers::pi;
    bool shown_ = false;
};

}  // namespace

Sensors to_sensors(const EpuckSensors& record) {
    Sensors sensors;
    for (std::size_t i = 0; i < sensors.proximity.size(); ++i) {
        sensors.proximity[i] = std::max<double>(0, record.proximity[i]);
        sensors.light[i] = kDarkest - record.light[i];
    }
    sensors.battery_ok = record.battery_ok != 0;
    return sensors;
}

EpuckActuators to_record(const Actuators& actuators) {
    EpuckActuators record;
    record.left = to_steps(actuators.left_mm_s);
    record.right = to_steps(actuators.right_mm_s);
    record.ring_leds = actuators.ring_leds;
    record.other_leds =
        static_cast<std::uint8_t>((actuators.front_led ? 1 : 0) | (actuators.body_led ? 2 : 0));
    if (actuators.word) {
        record.ircom_enabled = 1;
        record.ircom_data = *actuators.word;
    }
    return record;
}

bool run_control_loop(Session& session, Transport& transport, Behaviour& behaviour,
                      const Surroundings& surroundings, const std::function<bool()>& interrupted,
                      const LoopSettings& settings) {
    if (!session.start(transport.now() + settings.start_wait)) return false;
    const double begun = transport.now();
    const long steps = settings.duration > 0 ? std::lround(settings.duration / settings.period) : 0;
    WordFilter words;
    std::optional<InfraredWord> word;
    double next_word = 0;
    std::vector<EpuckSensors> heard;  // in the last step
    for (long step = 0; steps == 0 || step < steps;) {
        const double t = transport.now() - begun;
        const bool last = interrupted() || step + 1 == steps;
        EpuckActuators record;  // at rest
        if (!last && session.newest() && transport.now() - session.newest_time() < settings.stale_after) {
            Sensors sensors = to_sensors(heard.empty() ? *session.newest() : median_of(heard));
            if (surroundings.ground) sensors.ground = surroundings.ground();
            if (surroundings.neighbours) sensors.neighbours = surroundings.neighbours();
            if (surroundings.spots) sensors.spots = surroundings.spots();
            sensors.word = std::exchange(word, std::nullopt);
            Actuators actuators = behaviour.step(sensors, t);
            if (!actuators.word && settings.word >= 0 && t >= next_word && behaviour.may_send()) {
                actuators.word = static_cast<std::uint8_t>(settings.word);
                next_word = t + settings.word_every;
            }
            if (surroundings.say) surroundings.say(actuators.say);
            record = to_record(actuators);
        }
        heard.clear();
        for (int turn = 0; turn < (last ? 1 : settings.exchanges); ++turn) {
            if (turn > 0) {
                const double share = static_cast<double>(turn) / settings.exchanges;
                const double at = begun + (static_cast<double>(step) + share) * settings.period;
                if (transport.now() > at + kLateTurn || interrupted()) break;
                transport.sleep_until(at);
                record.ircom_enabled = 0;  // a word is sent once
            }
            if (const auto answer = session.exchange(record)) {
                heard.push_back(*answer);
                const auto came = words.take(*answer, record.ircom_enabled != 0);
                if (came && surroundings.heard) surroundings.heard(*came);
                if (came || turn == 0) word = came;
            }
            // A last record that went unanswered may not have been obeyed: get the robot to rest before the
            // end.
            const double give_up = transport.now() + (last ? kLastTry : settings.give_up);
            if (session.lost() && !session.resync(give_up) && !interrupted()) return false;
        }
        if (last) break;
        const long late = static_cast<long>(std::ceil((transport.now() - begun) / settings.period));
        step = std::max(step + 1, late);
        if (steps != 0) step = std::min(step, steps - 1);
        transport.sleep_until(begun + static_cast<double>(step) * settings.period);
    }
    session.end();
    return true;
}

}  // namespace puckloop::control
