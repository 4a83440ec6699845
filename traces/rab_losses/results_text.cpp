// The losses of a run as text and as JSON.

#include "base/json.h"
#include "traces/rab_losses/results.h"

#include <fmt/format.h>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;

/// "receiver_i2c 12, collision 3": what frames were lost by, those that occurred.
std::string causes_of(const RabGroup& group) {
    std::string text;
    for (std::size_t c = 0; c < kCauses; ++c)
        if (group.lost[c] > 0)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name_of(static_cast<Cause>(c)),
                                group.lost[c]);
    return text.empty() ? "-" : text;
}

std::string row_of(const RabGroup& group) {
    return fmt::format("{:22} {:>7} {:>9} {:>6.3f} {:>7.1f}  {}\n", group.name, group.frames, group.delivered,
                       group.share(), group.distance * 100.0, causes_of(group));
}

std::size_t frames_on_air(const RabResults& results, const std::string& sender) {
    const auto found = results.on_air.find(sender);
    return found == results.on_air.end() ? 0 : found->second;
}

std::size_t messages_of(const BoardTraffic& traffic) {
    std::size_t count = 0;
    for (const Poll& poll : traffic.polls)
        count += poll.message ? 1 : 0;
    return count;
}

std::uint64_t unexplained_of(const Losses& losses, const std::string& robot) {
    const auto found = losses.unexplained.find(robot);
    return found == losses.unexplained.end() ? 0 : found->second;
}

}  // namespace

std::string to_text(const RabResults& results, double bin) {
    std::string text = fmt::format("{:22} {:>7} {:>9} {:>6} {:>7}  {}\n", "", "frames", "delivered", "share",
                                   "mean cm", "lost, by cause");
    const auto groups = groups_of(results.losses, bin);
    for (const RabGroup& group : groups)
        text += row_of(group);
    text += fmt::format("{:22} {:>7} {:>9} {:>6.3f}\n\n", "published model", "", "", kPublishedDelivered);
    text += fmt::format("{:22} {:>7} {:>9}\n", "condition (all frames)", "met by", "lost");
    for (std::size_t c = 0; c + 1 < kCauses; ++c)
        text += fmt::format("{:22} {:>7} {:>9}\n", name_of(static_cast<Cause>(c)), groups[0].met[c],
                            groups[0].met_lost[c]);
    text += fmt::format("\n{:22} {:>7} {:>9} {:>7} {:>9} {:>8} {:>11}\n", "board", "asked", "on air", "polls",
                        "median ms", "messages", "unexplained");
    for (const auto& [robot, traffic] : results.boards)
        text +=
            fmt::format("{:22} {:>7} {:>9} {:>7} {:>9.2f} {:>8} {:>11}\n", robot, traffic.sends.size(),
                        frames_on_air(results, robot), traffic.polls.size(), poll_period(traffic.polls) * 1e3,
                        messages_of(traffic), unexplained_of(results.losses, robot));
    for (const PhaseLock& lock : results.locked)
        text += fmt::format("\nphases locked: {} begins {:.2f} ms ({:.0f} %) after {}, +- {:.2f} ms, in {} "
                            "frames of {:.2f} ms each: one fate repeats\n",
                            lock.follower, lock.phase * lock.period * 1e3, lock.phase * 100.0, lock.leader,
                            lock.spread * lock.period * 1e3, lock.frames, lock.period * 1e3);
    return text;
}

std::string to_json(const RabResults& results, double bin) {
    ordered_json groups = ordered_json::array();
    for (const RabGroup& group : groups_of(results.losses, bin)) {
        ordered_json lost, met;
        for (std::size_t c = 0; c < kCauses; ++c) {
            const std::string name(name_of(static_cast<Cause>(c)));
            lost[name] = group.lost[c];
            if (static_cast<Cause>(c) != Cause::Other)
                met[name] = {{"frames", group.met[c]}, {"lost", group.met_lost[c]}};
        }
        groups.push_back({{"group", group.name},
                          {"frames", group.frames},
                          {"delivered", group.delivered},
                          {"share", group.share()},
                          {"distance_m", group.distance},
                          {"lost_by_cause", lost},
                          {"conditions", met}});
    }
    ordered_json boards;
    for (const auto& [robot, traffic] : results.boards)
        boards[robot] = {{"sends_asked", traffic.sends.size()},
                         {"frames_on_air", frames_on_air(results, robot)},
                         {"polls", traffic.polls.size()},
                         {"poll_period_s", poll_period(traffic.polls)},
                         {"messages", messages_of(traffic)},
                         {"unexplained_messages", unexplained_of(results.losses, robot)}};
    ordered_json locked = ordered_json::array();
    for (const PhaseLock& lock : results.locked)
        locked.push_back({{"leader", lock.leader},
                          {"follower", lock.follower},
                          {"frames", lock.frames},
                          {"period_s", lock.period},
                          {"phase", lock.phase},
                          {"spread", lock.spread}});
    return ordered_json{
               {"from_s", results.from_s}, {"to_s", results.to_s}, {"seed_delivered", kPublishedDelivered},
               {"groups", groups},         {"boards", boards},     {"locked_phases", locked}}
               .dump(2) +
           "\n";
}

}  // namespace puckloop::tools
