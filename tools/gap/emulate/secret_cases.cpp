#include "tools/gap/emulate/secret_cases.h"

#include "gap/pipeline/analyse.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

namespace puckloop::gap::emulate {

SecretResult try_secret(const Secret& secret, const RecordOptions& given) {
    SecretResult result;
    result.secret = &secret;
    try {
        RecordOptions options = given;
        for (const std::string& assignment : secret.assignments)
            set_parameter(options.robot, assignment);
        const auto folder = given.scratch / "experiment";
        selftest::write_folder(record(secret.kind, options), folder);
        Options analysis;
        analysis.seed = given.seed;
        const Verdict verdict = analyse(read_experiment(folder), analysis);
        result.decision = std::string(decision_name(verdict.decision));
        for (const Cause& cause : verdict.causes) {
            result.named.push_back(cause.name);
            for (const FittedParameter& p : cause.parameters)
                result.told.push_back(
                    fmt::format("{} {:.4g} ({:.4g}..{:.4g}) {}", p.name, p.value, p.low, p.high, p.unit));
        }
        if (secret.names.empty())
            result.found = verdict.decision == Decision::NoEffect;
        else
            result.found = verdict.decision == Decision::Named &&
                           std::find(secret.names.begin(), secret.names.end(), result.named.front()) !=
                               secret.names.end();
    } catch (const std::exception& error) {
        result.decision = "error";
        result.error = error.what();
    }
    if (!given.keep) std::filesystem::remove_all(given.scratch);
    return result;
}

std::string secret_line(const SecretResult& r) {
    constexpr std::size_t kMostTold = 4;
    std::string names;
    for (const std::string& name : r.named)
        names += (names.empty() ? "" : ", ") + name;
    std::string text = fmt::format("{:<11}{:<46}{:<8}{:<12} {}{}\n", r.secret->kind, r.secret->what,
                                   r.found ? "found" : "MISSED", r.decision, names, r.error);
    for (std::size_t k = 0; k < std::min(r.told.size(), kMostTold); ++k)
        text += fmt::format("{:>13}{}\n", "", r.told[k]);
    return text;
}

std::string secrets_text(const std::vector<SecretResult>& results) {
    int changed = 0, found = 0, plain = 0, quiet = 0;
    std::string text;
    for (const SecretResult& r : results) {
        const bool hidden = !r.secret->names.empty();
        (hidden ? changed : plain) += 1;
        (hidden ? found : quiet) += r.found ? 1 : 0;
        text += secret_line(r);
    }
    return fmt::format("secret changes found: {} of {}; robots left alone called so: {} of {}\n\n{}", found,
                       changed, quiet, plain, text);
}

}  // namespace puckloop::gap::emulate
