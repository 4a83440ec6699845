// puckloop gap selftest: does the tool find what was hidden?

#include "base/error.h"
#include "gap/emulate/secret_cases.h"
#include "gap/selftest/run_cases.h"
#include "tools/commands/gap.h"
#include "tools/commands/number_checks.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <unistd.h>

namespace puckloop::tools {

namespace {

namespace st = gap::selftest;

constexpr std::size_t kQuick = 24;

struct Request {
    std::uint64_t cases = 0, seed = 1;
    unsigned workers = 2;
    std::string kind;
    bool quick = false, json = false, keep = false, emulator = false;
    std::filesystem::path scratch;
};

std::vector<st::CasePlan> chosen_plans(const Request& request) {
    auto plans = st::planned_cases(request.seed, request.quick ? kQuick : request.cases);
    if (!request.kind.empty())
        std::erase_if(plans, [&](const st::CasePlan& plan) {
            return st::benches()[plan.bench]->kind() != request.kind;
        });
    if (plans.empty())
        throw InputError("", "gap selftest", fmt::format("no case of kind '{}'", request.kind),
                         "proximity, motion, rab, microphone, ground, accelerometer or timing");
    return plans;
}

std::filesystem::path scratch_of(const Request& request) {
    if (!request.scratch.empty()) return request.scratch;
    return std::filesystem::temp_directory_path() / fmt::format("puckloop-selftest.{}", ::getpid());
}

/// Robots changed in secret; found all means 0.
int secret_test(const Request& request) {
    namespace em = gap::emulate;
    em::RecordOptions options;
    options.tools = emulation_tools();
    options.seed = request.seed;
    options.brief = request.quick;
    std::vector<em::SecretResult> results;
    for (const em::Secret& secret : em::secrets()) {
        if (!request.kind.empty() && request.kind != secret.kind) continue;
        options.scratch = scratch_of(request) / fmt::format("secret{:02}", results.size() + 1);
        results.push_back(em::try_secret(secret, options));
        if (::isatty(STDERR_FILENO) != 0)
            fmt::print(stderr, "\r{} of {} robots ", results.size(), em::secrets().size());
    }
    fmt::print("{}", em::secrets_text(results));
    return std::all_of(results.begin(), results.end(), [](const auto& r) { return r.found; }) ? 0 : 1;
}

int self_test(const Request& request) {
    if (request.emulator) return secret_test(request);
    st::RunOptions options;
    const bool own = request.scratch.empty();
    options.scratch = scratch_of(request);
    options.keep = request.keep;
    options.workers = request.workers;
    if (::isatty(STDERR_FILENO) != 0)
        options.done = [](std::size_t done, std::size_t all) {
            fmt::print(stderr, "\r{} of {} cases ", done, all);
        };
    const auto judged = st::run_cases(chosen_plans(request), options);
    if (options.done) fmt::print(stderr, "\n");
    if (own && !request.keep) std::filesystem::remove_all(options.scratch);
    fmt::print("{}\n",
               request.json ? st::report_json(judged, request.seed) : st::report_text(judged, request.seed));
    const auto wanted = st::requirements(judged);
    return std::all_of(wanted.begin(), wanted.end(), [](const st::Requirement& r) { return r.met(); }) ? 0
                                                                                                       : 1;
}

}  // namespace

void declare_gap_selftest(CLI::App& gap, int& status) {
    CLI::App* command = gap.add_subcommand("selftest", "Hide effects in made experiments and see what the "
                                                       "analysis says; status 1 when it misses its targets");
    auto request = std::make_shared<Request>();
    command->add_option("--cases", request->cases, "how many (default: all, over 300)")->type_name("N");
    command->add_option("--seed", request->seed, "of everything made up")->type_name("N");
    command->add_option("--kind", request->kind, "cases of this kind only")->type_name("KIND");
    command->add_option("--workers", request->workers, "cases at a time")->type_name("N");
    command->add_option("--scratch", request->scratch, "where the cases are written (a temporary folder)")
        ->type_name("DIR");
    command->add_flag("--keep", request->keep, "leave the cases' folders");
    command->add_flag("--emulator", request->emulator,
                      "robots changed in secret and recorded on the emulator, in place of made experiments");
    command->add_flag("--quick", request->quick, "a small sample");
    command->add_flag("--json", request->json, "the result for programs");
    command->callback([request, &status] { status = self_test(*request); });
}

}  // namespace puckloop::tools
