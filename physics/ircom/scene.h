#pragma once
// Where everything is that has to do with IRcom: the devices, which are the robots in the description's order
// and then the booths, and what can shade them. It follows the world's poses (physics/world/pose_signals.h).
//
// A robot has four lines of two diodes each (sensors i and i + 4) and eight phototransistors, a booth one of
// each. A pose takes effect a millisecond after it was known: so no light comes sooner to a device that is
// far from all others, which therefore can run ahead of them.

#include "cosim/core/time.h"
#include "physics/ircom/optics.h"

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace puckloop::physics {

/// From the message with a pose to its effect on light.
inline constexpr cosim::Time kIrcomPoseDelay = cosim::kMillisecond;
inline constexpr std::size_t kIrcomLines = 4;

/// Light of one line at one phototransistor.
struct IrcomShare {
    std::uint16_t device = 0, sensor = 0;
    double counts = 0.0;
};

class IrcomScene {
  public:
    /// `changes`: events may alter what is in the world. The description must have passed check().
    IrcomScene(const World& world, bool changes);

    std::size_t device_count() const { return devices_.size(); }
    const std::string& name(std::size_t device) const { return devices_[device].name; }
    bool is_booth(std::size_t device) const { return devices_[device].booth; }
    std::size_t lines(std::size_t device) const { return is_booth(device) ? 1 : kIrcomLines; }
    std::size_t sensors(std::size_t device) const { return devices_[device].parts.size(); }
    const IrcomParameters& parameters(std::size_t device) const { return devices_[device].parameters; }

    /// One of the port's signals, known at `now`; times do not decrease.
    void take(cosim::Time now, std::size_t id, double value);
    /// When the next one takes effect, or kNever.
    cosim::Time next_change() const { return pending_.empty() ? cosim::kNever : pending_.front().time; }
    /// What is due at `now` takes effect; true if anything was.
    bool apply(cosim::Time now);

    /// Another device's light may reach this one before kIrcomPoseDelay has passed.
    bool near(std::size_t device) const {
        if (near_stale_) find_near();
        return near_[device] != 0;
    }
    /// Where the light of a line arrives now; kept until something moves.
    const std::vector<IrcomShare>& light_of(std::size_t device, std::size_t line) const;

    /// All that time changes; what light_of() keeps is found anew where it no longer holds.
    template <class Archive>
    void state(Archive& archive) {
        archive(now_, known_, pending_, version_);
        if (changes_) archive(fixed_, added_);
        if constexpr (Archive::kLoads) {
            place_all();
            near_stale_ = true;
        }
    }

  private:
    struct Device {
        std::string name;
        bool booth = false;
        std::size_t body = 0;  ///< of a robot: index among what moves
        std::vector<IrcomPart> parts;
        double height = 0.0;
        IrcomParameters parameters;
    };
    /// A robot or movable thing.
    struct Body {
        double x = 0.0, y = 0.0, heading = 0.0;
        bool out = false;  ///< lifted or taken away
    };
    struct Pending {
        cosim::Time time = 0;
        std::size_t id = 0;
        double value = 0.0;
    };
    struct Row {
        std::uint64_t version = 0;
        std::vector<IrcomShare> shares;
    };
    struct Placed {
        double x = 0.0, y = 0.0;
        bool out = false;
        std::vector<IrcomPart> parts;
    };

    static void set(std::vector<Body>& bodies, std::size_t id, double value);
    void set_shape(std::size_t id, double value);
    void place_all();
    void place(std::size_t device);
    void find_near() const;
    bool close(std::size_t a, std::size_t b, const std::vector<Body>& bodies) const;
    std::vector<const Shape*> between(std::size_t a, std::size_t b) const;
    void couple(std::size_t device, std::size_t line, std::vector<IrcomShare>& shares) const;

    bool changes_;
    std::vector<Device> devices_;
    std::vector<Body> now_, known_;  ///< in effect; as last published
    std::deque<Pending> pending_;
    mutable std::vector<std::uint8_t> near_;
    mutable bool near_stale_ = true;
    std::vector<Shape> fixed_, added_;
    std::vector<Shape> bodies_;  ///< shapes of what moves
    std::vector<double> heights_;
    std::vector<Placed> placed_;
    /// Of the scene in effect; no two scenes have the same, those that were taken back included.
    std::uint64_t version_ = 1, versions_ = 1;
    mutable std::vector<Row> rows_;  ///< [device][line]
};

}  // namespace puckloop::physics
