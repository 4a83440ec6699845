#pragma once
// The twelve receivers of one board in time: carrier and level in, demodulator outputs and A/D counts out,
// each after its delay. Source: the range-and-bearing facts, sections 1.4 and 5.
//
// A demodulator's output goes active ir.delay_on after the carrier rose above the threshold, if it stayed for
// ir.min_burst, and back ir.delay_off after it fell below, if it stayed there for ir.min_gap. A level that
// rises shows ir.level_delay later; one that falls does once it has been lower for ir.level_hold, because the
// board's peak detector keeps the highest anyway.
//
// Gain control: a demodulator's threshold is ir.threshold or ir.gain_share of the strongest carrier,
// whichever is higher, so that a near board is heard through the light of far ones (capture). A carrier
// counts as the strongest until ir.gain_hold after it became weaker; what is there then takes its place.
//
// Deviation: threshold without hysteresis.

#include "cosim/core/time.h"
#include "physics/ir/ir_medium.h"

#include <deque>
#include <vector>

namespace puckloop::physics {

/// A message of the future. `index` 0..11 are demodulators (value 0 or 1), 12..23 levels (counts).
struct IrOutput {
    cosim::Time time = 0;
    std::uint8_t index = 0;
    double value = 0.0;
};
inline constexpr std::uint8_t kIrLevelOutput = kIrSensors;

class IrReceiver {
  public:
    explicit IrReceiver(const IrParameters& parameters);

    /// The light from `now` on. Times must not decrease; run_to(now) comes first.
    void see(cosim::Time now, const IrLight& light);
    /// Decides what is due at or before `now`.
    void run_to(cosim::Time now);

    /// Moves out what is final when everything before `until` has been seen, in order of time.
    void release(cosim::Time until, std::vector<IrOutput>& out);
    /// First output still to come if nothing changes any more.
    cosim::Time next_output() const;
    /// Shortest time from a change of light to an output.
    cosim::Time lookahead() const { return lookahead_; }

    template <class Archive>
    void state(Archive& archive) {
        archive(above_, rising_, falling_, lower_, level_, shown_, last_, outputs_);
        archive(carrier_, strongest_, fading_);
    }

  private:
    /// Receivers that changed together and may still change their mind.
    struct Change {
        cosim::Time begun = 0;
        std::uint16_t mask = 0;
    };
    static std::uint16_t take_back(std::deque<Change>& changes, std::uint16_t mask);
    void control_gain(cosim::Time now, const IrArray<float>& carrier);
    std::uint16_t above_threshold() const;
    bool is_above(std::size_t k) const {
        return carrier_[k] >= threshold_ && carrier_[k] >= gain_share_ * strongest_[k];
    }
    void demodulate(cosim::Time now, std::uint16_t above);
    void measure(cosim::Time now, const IrArray<float>& level);
    void put(cosim::Time time, std::size_t index, double value);
    void settle_bursts(cosim::Time now);
    void decide(const Change& change, cosim::Time delay, double value);

    cosim::Time delay_on_, delay_off_, min_burst_, min_gap_, level_delay_, level_hold_, gain_hold_;
    cosim::Time lookahead_, settled_;
    float threshold_, rail_, gain_share_;
    IrArray<float> carrier_{}, strongest_{};
    std::deque<Change> fading_;  ///< the strongest of these is over, but still holds the gain down
    std::uint16_t above_ = 0;
    std::deque<Change> rising_, falling_, lower_;
    IrArray<int> level_, shown_;
    std::array<cosim::Time, 2 * kIrSensors> last_{};
    std::deque<IrOutput> outputs_;  // by time, then index
};

}  // namespace puckloop::physics
