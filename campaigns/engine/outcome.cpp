#include "campaigns/engine/outcome.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace puckloop::faults {

using nlohmann::json;

namespace {

constexpr std::array<std::string_view, 10> kNames{
    "puckloop failed", "not fired", "crash",    "reset loop",        "hang",
    "degraded",        "recovered", "detected", "silent corruption", "masked"};
constexpr double kPauseShare = 0.5;  ///< a pause has to exceed the nominal one's by this share, too

double end_of(const Profile& run) {
    const json& asked = run.report.value("programs_asked_to_end_s", json());
    return asked.is_number() ? asked.get<double>() : run.report.value("simulated_s", 0.0);
}

/// Longest time between two frames, or from the last one to `end`.
double longest_pause(const Sender& sender, double end, double from = 0) {
    double longest = 0, before = -1;
    for (const double time : sender.times) {
        if (time > end) break;
        if (before >= 0 && time > from) longest = std::max(longest, time - before);
        before = time;
    }
    return longest;
}

double last_before(const Sender& sender, double end) {
    const auto after = std::upper_bound(sender.times.begin(), sender.times.end(), end);
    return after == sender.times.begin() ? -1 : *(after - 1);
}

std::size_t resets_of(const json& node) {
    return node.contains("resets") && node.at("resets").is_array() ? node.at("resets").size() : 0;
}

/// For how long at most the wheels of a robot turned on after a byte to its main board until the next one, s;
/// below 0 if they never did, or if nobody sent it anything.
double blind_drive(const Profile& run, const std::string& robot, double end) {
    std::vector<double> commands;
    for (const auto& [name, sender] : run.senders)
        if (name.starts_with(robot + ".") && name.find(".i2c") == std::string::npos &&
            !name.ends_with(" from " + robot + ".pic"))
            commands.insert(commands.end(), sender.times.begin(), sender.times.end());
    std::sort(commands.begin(), commands.end());
    const auto turns = run.turns.find(robot);
    double longest = -1;
    if (turns == run.turns.end()) return longest;
    for (const double time : turns->second) {
        if (time > end) break;
        const auto next = std::upper_bound(commands.begin(), commands.end(), time);
        if (next != commands.begin()) longest = std::max(longest, time - *(next - 1));
    }
    return longest;
}

/// The faults' evidence in the report: those of the case are the last ones.
void read_fired(const Profile& run, std::size_t faults, Verdict& verdict) {
    const json& all = run.report.at("faults");
    verdict.first_s = run.first_fault_s;
    const std::size_t skip = all.size() > faults ? all.size() - faults : 0;
    for (std::size_t i = skip; i < all.size(); ++i) {
        verdict.fired.push_back(all[i].value("fired", std::uint64_t{0}));
        const json when = all[i].value("first_s", json());
        if (!when.is_number()) continue;
        const double first = when.get<double>();
        if (!verdict.first_s || first < *verdict.first_s) verdict.first_s = first;
    }
    verdict.fired.resize(faults, 0);
}

/// What the conductor and the shim say of a node that keeps simulated time from passing.
bool is_stall(const std::string& why) {
    return why.find("has not let time pass") != std::string::npos ||
           why.find("has not answered for") != std::string::npos;
}

/// Paths by their last part alone: where a program lies is no symptom.
std::string without_folders(const std::string& text) {
    std::string left;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const std::size_t end = std::min(text.find_first_of(" ,:;", i), text.size());
        const std::size_t last = end > i ? text.rfind('/', end - 1) : i;
        if (text[i] == '/' && last > i)
            i = last;
        else
            left += text[i];
    }
    return left;
}

struct Judge {
    const Campaign& campaign;
    const Profile& nominal;
    const Profile& run;
    Verdict& verdict;

    /// What went wrong first is the cause of what follows from it; the first in the order of outcomes counts.
    void blame(const std::string& cause) {
        if (verdict.cause.empty()) verdict.cause = cause;
    }

    void note(std::string symptom, const std::string& when = {}) {
        verdict.detail += fmt::format("{}{}{}", verdict.detail.empty() ? "" : "; ", symptom, when);
        verdict.symptoms.push_back(std::move(symptom));
    }

    /// A run that went on to its end with a board that hangs or a silent line is no crash of anything.
    static bool succeeded(const json& report) {
        if (report.value("success", false)) return true;
        const auto failures = report.find("failures");
        return failures != report.end() && !failures->empty();
    }

    /// The run ended where the emulator itself could not go on.
    bool failed() {
        const std::string why = run.report.value("ended_why", "");
        if (run.report.value("ended_by", "") != "failed" || is_stall(why)) return false;
        note(shape_of(without_folders(why)), fmt::format(" ({})", why));
        return true;
    }

    bool crashed() {
        const bool success = succeeded(run.report);
        const std::string why = run.report.value("ended_why", "");
        if (success || !nominal.report.value("success", false)) return false;
        // A program that computes for ever without a call stalls simulated time: no crash.
        if (is_stall(why) || why.find("never fired") != std::string::npos) return false;
        note(shape_of(without_folders(why)), fmt::format(" ({})", why));
        blame(verdict.symptoms.back());
        return true;
    }

    bool reset_again_and_again() {
        bool loop = false;
        for (const auto& [name, node] : run.report.at("nodes").items()) {
            const auto before = nominal.report.at("nodes").find(name);
            const std::size_t usual = before == nominal.report.at("nodes").end() ? 0 : resets_of(*before);
            const std::size_t now = resets_of(node);
            if (now < usual + static_cast<std::size_t>(campaign.limits.resets)) continue;
            note(name + " is reset again and again", fmt::format(" ({} times)", now));
            blame(verdict.symptoms.back());
            loop = true;
        }
        return loop;
    }

    bool hung() {
        bool silent = false;
        const double end = std::min(end_of(nominal), end_of(run));
        // All programs ended as they do when their work is done, and it was not.
        if (succeeded(run.report) && end < end_of(nominal) - campaign.limits.silence) {
            note("the run ends early", fmt::format(" (at {:.6f} s)", end));
            blame(verdict.symptoms.back());
            return true;
        }
        std::optional<double> earliest;
        std::string first;
        for (const auto& [name, usual] : nominal.senders) {
            const double limit = std::max(campaign.limits.silence, 1.5 * longest_pause(usual, end));
            if (last_before(usual, end) < end - limit) continue;
            const auto now = run.senders.find(name);
            const double last = now == run.senders.end() ? -1 : last_before(now->second, end);
            if (last >= end - limit) continue;
            note(name + " falls silent", last < 0 ? std::string(" (from the begin on)")
                                                  : fmt::format(" (last frame at {:.6f} s)", last));
            silent = true;
            if (earliest && last >= *earliest) continue;
            earliest = last;
            first = verdict.symptoms.back();
        }
        if (!run.report.value("success", false) && nominal.report.value("success", false)) {
            const std::string why = run.report.value("ended_why", "");
            if (is_stall(why)) {
                note("a program computes for ever", fmt::format(" ({})", why));
                blame(verdict.symptoms.back());
                silent = true;
            }
        }
        blame(first);
        return silent;
    }

    /// Robots whose wheels turned on for longer without a byte to their main board than in the nominal run.
    void notice_blind_drives() {
        const double end = std::min(end_of(nominal), end_of(run));
        for (const auto& [robot, turns] : run.turns) {
            const double blind = blind_drive(run, robot, end);
            const double usual = std::max(0.0, blind_drive(nominal, robot, end));
            if (blind <= usual + campaign.limits.silence) continue;
            note(fmt::format("wheels of {} turned after the last command", robot),
                 fmt::format(" (for {:.3f} s)", blind));
        }
    }

    bool degraded() {
        bool worse = false;
        for (const Metric& metric : campaign.metrics) {
            const auto usual = measure(metric, nominal), now = measure(metric, run);
            verdict.metrics.emplace_back(metric.name, now);
            const double allowed =
                metric.relative ? metric.tolerance * std::abs(usual.value_or(0)) : metric.tolerance;
            if (usual.has_value() == now.has_value() && (!usual || std::abs(*now - *usual) <= allowed))
                continue;
            note(metric.name + (now.value_or(0) < usual.value_or(0) ? " too small" : " too large"),
                 fmt::format(" ({:.6g}, nominal {:.6g})", now.value_or(NAN), usual.value_or(NAN)));
            blame(verdict.symptoms.back());
            worse = true;
        }
        return worse;
    }

    bool recovered() {
        const double end = std::min(end_of(nominal), end_of(run));
        const double from = verdict.first_s.value_or(0);
        std::optional<double> until;
        for (const auto& [name, now] : run.senders) {
            const auto usual = nominal.senders.find(name);
            if (usual == nominal.senders.end()) continue;
            const double longest = longest_pause(usual->second, end);
            const double limit = std::max(longest * (1 + kPauseShare), longest + campaign.limits.pause);
            std::optional<double> over;
            for (std::size_t i = 1; i < now.times.size() && now.times[i] <= end; ++i)
                if (now.times[i] > from && now.times[i] - now.times[i - 1] > limit) over = now.times[i];
            if (!over) continue;
            note(name + " pauses", fmt::format(" (until {:.6f} s)", *over));
            until = std::max(until.value_or(0), *over);
        }
        if (until) verdict.recovery_s = *until - from;
        return until.has_value();
    }

    bool reported() {
        bool said = false;
        for (const auto& [name, count] : run.error_counters) {
            const auto usual = nominal.error_counters.find(name);
            if (count <= (usual == nominal.error_counters.end() ? 0.0 : usual->second)) continue;
            const std::string shown = name.starts_with("nodes.") ? name.substr(6) : name;
            note(shown + " counts up",
                 fmt::format(" ({:g})",
                             count - (usual == nominal.error_counters.end() ? 0.0 : usual->second)));
            said = true;
        }
        for (const std::string& line : run.log_shapes) {
            if (nominal.log_shapes.contains(line)) continue;
            note("log of " + line);
            said = true;
        }
        return said;
    }

    void measure_departure() {
        for (const auto& [robot, path] : run.paths) {
            const auto usual = nominal.paths.find(robot);
            if (usual == nominal.paths.end()) continue;
            for (const auto& [time, pose] : path)
                if (const auto there = usual->second.find(time); there != usual->second.end())
                    verdict.departure_m = std::max(
                        verdict.departure_m, std::hypot(pose.x - there->second.x, pose.y - there->second.y));
        }
    }
};

}  // namespace

std::string_view name_of(Outcome outcome) {
    return kNames.at(static_cast<std::size_t>(outcome));
}

std::optional<Outcome> outcome_of(std::string_view name) {
    const auto found = std::find(kNames.begin(), kNames.end(), name);
    if (found == kNames.end()) return std::nullopt;
    return static_cast<Outcome>(found - kNames.begin());
}

bool is_finding(Outcome outcome) {
    return outcome == Outcome::PuckloopFailed || outcome == Outcome::Crash || outcome == Outcome::ResetLoop ||
           outcome == Outcome::Hang || outcome == Outcome::Degraded || outcome == Outcome::SilentCorruption;
}

std::optional<double> measure(const Metric& metric, const Profile& run) {
    if (!metric.robot.empty()) return path_length(run, metric.robot);
    if (!metric.log.empty()) {
        const auto log = run.logs.find(metric.log);
        if (log == run.logs.end()) return std::nullopt;
        return std::count_if(log->second.begin(), log->second.end(), [&](const std::string& line) {
            return line.find(metric.lines) != std::string::npos;
        });
    }
    const json::json_pointer place(metric.value);
    if (!run.report.contains(place) || !run.report.at(place).is_number()) return std::nullopt;
    return run.report.at(place).get<double>();
}

Verdict failed_verdict(std::size_t faults, const std::string& why) {
    Verdict verdict;
    verdict.outcome = Outcome::PuckloopFailed;
    verdict.fired.resize(faults, 0);
    verdict.symptoms = {shape_of(without_folders(why))};
    verdict.detail = why;
    return verdict;
}

Verdict judge(const Campaign& campaign, const Profile& nominal, const Profile& run, std::size_t faults) {
    Verdict verdict;
    verdict.trace_sha256 = run.report.value("trace_sha256", "");
    read_fired(run, faults, verdict);
    Judge judge{campaign, nominal, run, verdict};
    if (judge.failed()) {
        // How far it came shows nothing of the robot, and may hang on where the run began.
        verdict.outcome = Outcome::PuckloopFailed;
        verdict.trace_sha256.clear();
        return verdict;
    }
    judge.measure_departure();
    // All are looked at, so that the symptoms are whole; the first that is true decides.
    const bool crash = judge.crashed(), loop = judge.reset_again_and_again(), hang = judge.hung(),
               degraded = judge.degraded(), recovered = judge.recovered(), reported = judge.reported();
    if (std::any_of(verdict.fired.begin(), verdict.fired.end(), [](auto count) { return count == 0; }))
        verdict.outcome = Outcome::NotFired;
    else if (crash)
        verdict.outcome = Outcome::Crash;
    else if (loop)
        verdict.outcome = Outcome::ResetLoop;
    else if (hang)
        verdict.outcome = Outcome::Hang;
    else if (degraded)
        verdict.outcome = Outcome::Degraded;
    else if (recovered)
        verdict.outcome = Outcome::Recovered;
    else if (reported)
        verdict.outcome = Outcome::Detected;
    else if (verdict.departure_m > campaign.limits.departure) {
        verdict.outcome = Outcome::SilentCorruption;
        verdict.detail =
            fmt::format("up to {:.1f} cm from where the nominal run's robot was", 100 * verdict.departure_m);
        judge.blame("wrong data were taken for right");
    }
    judge.notice_blind_drives();
    if (verdict.outcome != Outcome::Recovered) verdict.recovery_s.reset();
    if (!is_finding(verdict.outcome)) verdict.cause.clear();
    return verdict;
}

json to_json(const Verdict& verdict) {
    json metrics = json::array();
    for (const auto& [name, value] : verdict.metrics)
        metrics.push_back({{"name", name}, {"value", value ? json(*value) : json()}});
    return {{"outcome", name_of(verdict.outcome)},
            {"fired", verdict.fired},
            {"first_s", verdict.first_s ? json(*verdict.first_s) : json()},
            {"recovery_s", verdict.recovery_s ? json(*verdict.recovery_s) : json()},
            {"departure_m", verdict.departure_m},
            {"metrics", metrics},
            {"symptoms", verdict.symptoms},
            {"detail", verdict.detail},
            {"cause", verdict.cause},
            {"trace_sha256", verdict.trace_sha256}};
}

Verdict verdict_from_json(const json& text) {
    Verdict verdict;
    verdict.outcome = outcome_of(text.at("outcome").get<std::string>()).value();
    verdict.fired = text.at("fired").get<std::vector<std::uint64_t>>();
    if (text.at("first_s").is_number()) verdict.first_s = text.at("first_s").get<double>();
    if (text.at("recovery_s").is_number()) verdict.recovery_s = text.at("recovery_s").get<double>();
    verdict.departure_m = text.at("departure_m");
    for (const json& metric : text.at("metrics"))
        verdict.metrics.emplace_back(metric.at("name"), metric.at("value").is_number()
                                                            ? std::optional(metric.at("value").get<double>())
                                                            : std::nullopt);
    verdict.symptoms = text.at("symptoms").get<std::vector<std::string>>();
    verdict.detail = text.at("detail");
    verdict.cause = text.value("cause", "");
    verdict.trace_sha256 = text.at("trace_sha256");
    return verdict;
}

}  // namespace puckloop::faults
