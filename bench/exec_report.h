#pragma once
// What a run on the bench prints when it is over.

#include "bench/bench.h"
#include "bench/options.h"

#include <span>
#include <string>
#include <vector>

namespace puckloop::exec {

struct ExecOutcome {
    Bench::End end = Bench::End::Time;
    std::string stopped;   ///< what the user called the address, "budget" or "interrupted"
    std::uint32_t pc = 0;  ///< program counter at the end
    std::string symbol;    ///< of `pc`, if the image has one
    std::string line{};    ///< "main.c:12", if the image has source lines
    double wall_s = 0.0;
    bool success = false;
    std::string stats_text{};  ///< of --stats
    std::string stats_json{};  ///< the same as a JSON object; empty: none
    std::string failure{};     ///< why not, where the rest of the report does not say it
};

/// The target's, and what live ends have lost.
std::vector<std::string> warnings_of(Bench& bench);

/// One JSON object on one line.
std::string json_report(Bench& bench, const image::Image& image, const ExecOutcome& outcome);
/// A few lines for a person.
std::string text_report(Bench& bench, const ExecOutcome& outcome);

/// `--list-signals`: one line per signal, or one JSON array on one line.
std::string signals_text(std::span<const cosim::SignalInfo> signals);
std::string signals_json(std::span<const cosim::SignalInfo> signals);

}  // namespace puckloop::exec
