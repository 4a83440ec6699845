#pragma once
// Sound through the world: what robots' speakers do comes in with their signals, what loudspeakers that play
// waves do is known (physics/sensors/speaker_wave.h); the waves at every robot's
// three microphones go out, 16 samples a step, while there is anything to hear.

#include "cosim/core/message.h"
#include "physics/sensors/sound_waves.h"
#include "physics/world/world_model.h"

#include <array>
#include <cstdint>
#include <vector>

namespace puckloop::physics {

class SoundLink {
  public:
    /// `ports_of_robot`: ports of the node a robot, the board's first.
    SoundLink(const World& world, std::size_t ports_of_robot);

    /// A signal of the board of `robot`, at `seconds`.
    void take(std::size_t robot, std::uint16_t id, double value, double seconds);
    /// The waves from `stamp` on for a step; the model stands one step before.
    void publish(const WorldModel& model, cosim::Time stamp, std::vector<cosim::Message>& outbox);

  private:
    struct Robot {
        cosim::PortIndex port = 0;
        std::uint16_t speaker = 0;
        std::array<std::uint16_t, kMicrophones> sound{};
        std::array<double, kMicrophones> last{};  ///< as published
        SoundTrack track;
        MicrophoneParameters microphones;
        bool hears = false;
    };
    /// A speaker that is heard in this step: a robot's by its track, or the scenario's.
    struct Source {
        double x = 0.0, y = 0.0, height = 0.0;
        double swing = 0.0;  ///< counts of a full-scale value at the level's distance
        const SoundTrack* track = nullptr;
        const Speaker* speaker = nullptr;
    };
    bool any_speaker(const WorldModel& model) const;
    void find_sources(const WorldModel& model);
    double value_of(const Source& source, double seconds) const;
    void publish_to(Robot& robot, const RobotState& state, cosim::Time stamp,
                    std::vector<cosim::Message>& outbox);

    std::uint64_t seed_;
    std::vector<Robot> robots_;
    std::vector<Source> sources_;
    bool sounding_ = false;
};

}  // namespace puckloop::physics
