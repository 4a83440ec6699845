#include "physics/tracker/overhead.h"

#include "base/json.h"

#include <utility>

namespace puckloop::physics {

namespace {

/// Ids of the mission program's commands; those of others are counted from 1.
constexpr std::uint64_t kMission = std::uint64_t{1} << 63;

}  // namespace

Overhead::Overhead(TrackerPlan plan, std::unique_ptr<CommandSource> others, const WorldModel& model)
    : plan_(std::move(plan)),
      others_(std::move(others)),
      tracker_(plan_.spec, model.description().arena.corners, model.description().seed, model.robot_count()) {
    const std::string& directory = model.description().recording.directory;
    if (!directory.empty()) record_.emplace(directory + "/tracker.csv", model.description());
}

void Overhead::at_step(const WorldModel& model, const Journal& journal) {
    const std::uint64_t step = model.steps_done();
    if (step == 0 && plan_.mission) take(plan_.mission->begin(model.description(), plan_.spec), step);
    if (tracker_.due(step)) {
        robots_.clear();
        for (std::size_t i = 0; i < model.robot_count(); ++i)
            robots_.push_back(model.state(i));
        TrackerFrame frame = tracker_.see(step, robots_);
        if (record_) record_->add(frame);
        if (plan_.mission) under_way_.push_back(std::move(frame));
    }
    for (; !under_way_.empty() && under_way_.front().arrives <= step; under_way_.pop_front()) {
        if (stop_) continue;
        const std::span<const Journal::Entry> done = std::span(journal.entries()).subspan(reported_);
        reported_ += done.size();
        take(plan_.mission->frame(under_way_.front(), done, std::exchange(refused_, {})), step);
    }
}

void Overhead::take(MissionAnswer answer, std::uint64_t step) {
    if (answer.end || answer.failed)
        stop_ = cosim::Stop{.time = static_cast<cosim::Time>(step) * cosim::kMillisecond,
                            .success = !answer.failed,
                            .reason = std::move(answer.why)};
    for (Action& act : answer.acts)
        asked_.push_back(std::move(act));
}

std::string Overhead::finish(double seconds) {
    return plan_.mission ? plan_.mission->end(seconds) : std::string();
}

std::vector<Command> Overhead::poll() {
    std::vector<Command> commands;
    for (Action& act : std::exchange(asked_, {})) {
        const std::uint64_t id = kMission + ++last_id_;
        waiting_[id] = act.command;
        commands.push_back({id, std::move(act)});
    }
    if (!others_) return commands;
    for (Command& command : others_->poll())
        commands.push_back(std::move(command));
    return commands;
}

void Overhead::reply(std::uint64_t id, const std::string& json) {
    if (id < kMission) {
        if (others_) others_->reply(id, json);
        return;
    }
    const auto asked = waiting_.find(id);
    const auto reply = nlohmann::json::parse(json);
    if (reply.contains("refused"))
        refused_.push_back({asked->second, reply.at("refused").get<std::string>(),
                            cosim::from_seconds(reply.value("at_s", 0.0))});
    waiting_.erase(asked);
}

}  // namespace puckloop::physics
