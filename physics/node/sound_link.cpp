#include "physics/node/sound_link.h"

#include "physics/description/robot_parameters.h"
#include "physics/node/robot_links.h"
#include "physics/sensors/speaker_wave.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

/// As long as a sound is on its way through the largest arena there is to hear it in.
constexpr double kOnTheWay = 0.1;        // s
constexpr double kSoundQuantum = 0.125;  // counts
/// Largest minus smallest value of a full-scale tone 0.1 m before a plain microphone; an assumption.
constexpr double kSpeakerLevel = 600;     // counts
constexpr double kSpeakerHeight = 0.045;  // m, above the middle of the axle; an assumption

}  // namespace

SoundLink::SoundLink(const World& world, std::size_t ports_of_robot) : seed_(world.seed) {
    for (const auto& described : world.robots) {
        Robot robot;
        const auto id_of = [&](const std::string& name) {
            const auto found = described.board_signals.find(name);
            return found == described.board_signals.end() ? kUnusedSignal : found->second;
        };
        robot.port = static_cast<cosim::PortIndex>(robots_.size() * ports_of_robot);
        robot.speaker = id_of("speaker");
        robot.hears = true;
        robot.microphones = parameters_of(world, described).microphone;
        for (std::size_t i = 0; i < kMicrophones; ++i) {
            robot.sound[i] = id_of(fmt::format("sound{}", i));
            robot.hears &= robot.sound[i] != kUnusedSignal;
        }
        robots_.push_back(robot);
    }
}

void SoundLink::take(std::size_t robot, std::uint16_t id, double value, double seconds) {
    if (id == robots_[robot].speaker && id != kUnusedSignal) {
        robots_[robot].track.change(seconds, value);
        sounding_ = true;
    }
}

bool SoundLink::any_speaker(const WorldModel& model) const {
    const auto& speakers = model.description().speakers;
    return std::any_of(speakers.begin(), speakers.end(), [&](const Speaker& speaker) {
        return is_wave(speaker) && plays_within(speaker, model.seconds() - kOnTheWay, model.seconds());
    });
}

void SoundLink::find_sources(const WorldModel& model) {
    const double now = model.seconds();
    sources_.clear();
    for (std::size_t i = 0; i < robots_.size(); ++i) {
        robots_[i].track.forget(now - kOnTheWay);
        if (robots_[i].track.silent_from(now - kOnTheWay)) continue;
        sources_.push_back(
            {model.state(i).x, model.state(i).y, kSpeakerHeight, kSpeakerLevel / 2, &robots_[i].track});
    }
    for (const Speaker& speaker : model.description().speakers)
        if (is_wave(speaker) && plays_within(speaker, now - kOnTheWay, now))
            sources_.push_back({speaker.x, speaker.y, speaker.height, speaker.level / 2, nullptr, &speaker});
}

void SoundLink::publish(const WorldModel& model, cosim::Time stamp, std::vector<cosim::Message>& outbox) {
    if (!sounding_ && !any_speaker(model)) return;
    find_sources(model);
    for (std::size_t i = 0; i < robots_.size(); ++i)
        if (robots_[i].hears) publish_to(robots_[i], model.state(i), stamp, outbox);
    sounding_ = !sources_.empty();
}

double SoundLink::value_of(const Source& source, double seconds) const {
    return source.track ? source.track->at(seconds) : wave_of(*source.speaker, seed_, seconds);
}

void SoundLink::publish_to(Robot& robot, const RobotState& state, cosim::Time stamp,
                           std::vector<cosim::Message>& outbox) {
    std::array<std::array<double, kSoundSamples>, kMicrophones> waves{};
    const double begin = cosim::to_seconds(stamp) - kSoundLatency;
    const double period = cosim::to_seconds(kSoundPeriod);
    for (const Source& source : sources_) {
        const auto ways = sound_ways(robot.microphones, state, begin, source.x, source.y, source.height);
        for (std::size_t mic = 0; mic < kMicrophones; ++mic) {
            const double swing = source.swing * ways[mic].share;
            const double made = begin - ways[mic].distance / kSpeedOfSound;
            for (std::size_t i = 0; i < kSoundSamples; ++i)
                waves[mic][i] += swing * value_of(source, made + static_cast<double>(i) * period);
        }
    }
    for (std::size_t i = 0; i < kSoundSamples; ++i)
        for (std::size_t mic = 0; mic < kMicrophones; ++mic) {
            const double value = std::round(waves[mic][i] / kSoundQuantum) * kSoundQuantum;
            if (value == robot.last[mic]) continue;
            robot.last[mic] = value;
            const cosim::Time time = stamp + static_cast<cosim::Time>(i) * kSoundPeriod;
            outbox.push_back({time, robot.port, cosim::Signal{robot.sound[mic], value}});
        }
}

}  // namespace puckloop::physics
