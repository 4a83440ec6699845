#pragma once
// What a case's faults did, judged against the nominal run; the definitions are in docs/faults.md.

#include "campaigns/engine/campaign_file.h"
#include "campaigns/engine/profile.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::faults {

enum class Outcome {
    PuckloopFailed,
    NotFired,
    Crash,
    ResetLoop,
    Hang,
    Degraded,
    Recovered,
    Detected,
    SilentCorruption,
    Masked,
};
/// In the order of their precedence.
inline constexpr std::array kOutcomes{Outcome::PuckloopFailed, Outcome::NotFired, Outcome::Crash,
                                      Outcome::ResetLoop,      Outcome::Hang,     Outcome::Degraded,
                                      Outcome::Recovered,      Outcome::Detected, Outcome::SilentCorruption,
                                      Outcome::Masked};

std::string_view name_of(Outcome outcome);
std::optional<Outcome> outcome_of(std::string_view name);
/// Puckloop failed, crash, reset loop, hang, degraded, silent corruption.
bool is_finding(Outcome outcome);

struct Verdict {
    Outcome outcome = Outcome::Masked;
    std::vector<std::uint64_t> fired;  ///< by each of the case's faults
    std::optional<double> first_s;     ///< when the first of them did something
    std::optional<double> recovery_s;  ///< recovered: from first_s on
    double departure_m = 0.0;          ///< greatest, of any robot
    std::vector<std::pair<std::string, std::optional<double>>> metrics;
    std::vector<std::string> symptoms;  ///< in a fixed order, without times
    std::string detail;                 ///< with times
    std::string cause;                  ///< of a finding: what went wrong first, without times
    std::string trace_sha256;
};

nlohmann::json to_json(const Verdict& verdict);
Verdict verdict_from_json(const nlohmann::json& text);

/// Value of a metric in a run; none if the run has no such number.
std::optional<double> measure(const Metric& metric, const Profile& run);

/// Of a run that the emulator itself did not survive; `why` in one line.
Verdict failed_verdict(std::size_t faults, const std::string& why);

/// `faults`: how many the case has; they are the last of the report's. `duration`: simulated time after which
/// programs are asked to end, s.
Verdict judge(const Campaign& campaign, const Profile& nominal, const Profile& run, std::size_t faults);

}  // namespace puckloop::faults
