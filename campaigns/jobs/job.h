#pragma once
// A unit of work that some worker carries out: one run of a campaign or of an experiment.

#include "base/json.h"

#include <functional>
#include <string>
#include <vector>

namespace puckloop::jobs {

constexpr int kTries = 3;  ///< of a job whose process died or that could not be carried out

struct Job {
    int id = 0;           ///< from 1
    nlohmann::json what;  ///< one line for the worker
};

/// How workers are started, and what users read of them.
struct Crew {
    std::vector<std::string> words;  ///< of puckloop: a worker that reads jobs from its standard input
    std::string noun = "case";       ///< what a job is in messages
};

/// The result of a job whose process died each time.
using DeadlyResult = std::function<nlohmann::json(const Job& job, const std::string& why)>;

/// Takes what came of a job; called once for each.
using TakeResult = std::function<void(int id, const nlohmann::json& result)>;

}  // namespace puckloop::jobs
