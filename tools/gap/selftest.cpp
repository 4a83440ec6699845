// puckloop gap selftest: does the tool find what was hidden?

#include "base/error.h"
#include "gap/kinds/read_kind.h"
#include "selftest/described/described.h"
#include "selftest/emulate/hidden_terms.h"
#include "selftest/emulate/secret_cases.h"
#include "selftest/run_cases.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/gap/folders.h"
#include "tools/gap/subcommands.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <unistd.h>

namespace puckloop::tools {

namespace {

namespace st = gap::selftest;

constexpr std::size_t kQuick = 24;
constexpr std::size_t kDrawn = 56, kAllDrawn = 1120;  // two and forty of each kind and class
constexpr std::size_t kDescribed = 60, kQuickDescribed = 6;
constexpr std::size_t kBeyond = 40;
constexpr std::uint64_t kMostCases = 100'000;
constexpr double kMostWorkers = 256;

struct SelftestRequest {
    std::uint64_t cases = 0, seed = 1;
    std::vector<std::size_t> only;
    unsigned workers = 2;
    std::string kind, of;
    bool grammar = false, full = false, draw_runs = false, ask_all = false, power = false;
    bool beyond = false;
    bool quick = false, json = false, keep = false, emulator = false, closed_loop = false, seed_given = false;
    std::filesystem::path scratch, svg;
    std::vector<std::string> pool;
};

struct Chosen {
    std::vector<st::CasePlan> plans;
    std::vector<std::size_t> number;  ///< of each, in the whole list
};

Chosen chosen_plans(const SelftestRequest& request) {
    const auto plans = st::planned_cases(request.seed, request.quick ? kQuick : request.cases);
    Chosen chosen;
    bool kind_known = request.kind.empty();
    for (std::size_t k = 0; k < plans.size(); ++k) {
        const bool kind = request.kind.empty() || st::benches()[plans[k].bench]->kind() == request.kind;
        kind_known = kind_known || kind;
        const auto& only = request.only;
        if (!kind || (!only.empty() && std::find(only.begin(), only.end(), k) == only.end())) continue;
        chosen.plans.push_back(plans[k]);
        chosen.number.push_back(k);
    }
    if (!kind_known)
        throw InputError("", "gap selftest", fmt::format("no case of kind '{}'", request.kind),
                         "proximity, motion, rab, microphone, ground, accelerometer or timing");
    if (chosen.plans.empty())
        throw InputError("", "gap selftest", "no case has the number given with --case",
                         fmt::format("0..{}", plans.size() - 1));
    return chosen;
}

std::filesystem::path scratch_of(const SelftestRequest& request) {
    if (!request.scratch.empty()) {
        prepare_folder(request.scratch);
        return request.scratch;
    }
    return std::filesystem::temp_directory_path() / fmt::format("puckloop-selftest.{}", ::getpid());
}

/// Robots changed in secret; found all means 0.
int secret_test(const SelftestRequest& request) {
    namespace em = gap::emulate;
    em::RecordOptions options;
    options.tools = emulation_tools();
    options.seed = request.seed_given || request.closed_loop ? request.seed : fresh_seed();
    fmt::print(stderr, "seed {}\n", options.seed);
    options.brief = request.quick;
    options.keep = request.keep;
    std::vector<em::SecretResult> results;
    for (std::size_t k = 0; k < em::secrets().size(); ++k) {
        if (!request.kind.empty() && request.kind != em::secrets()[k].kind) continue;
        if (!request.only.empty() &&
            std::find(request.only.begin(), request.only.end(), k) == request.only.end())
            continue;
        options.scratch = scratch_of(request) / fmt::format("robot{:02}", k);
        refuse_foreign_files(options.scratch);
        results.push_back(em::try_secret(k, request.closed_loop, options));
        fmt::print(stderr, "{:>3} {}", k, em::secret_line(results.back()));
    }
    if (results.empty())
        throw InputError("", "gap selftest", "no robot changed in secret is of this kind and number",
                         fmt::format("0..{}", em::secrets().size() - 1));
    fmt::print("{}", em::secrets_text(results));
    return std::all_of(results.begin(), results.end(), [](const auto& r) { return r.found; }) ? 0 : 1;
}

/// A kind that its user described, by its own formulas.
int described_self_test(const SelftestRequest& request) {
    const std::pair<const char*, bool> others[] = {{"--grammar", request.grammar},
                                                   {"--emulator", request.emulator},
                                                   {"--json", request.json},
                                                   {"--case", !request.only.empty()}};
    for (const auto& [option, given] : others)
        if (given) throw InputError("", option, "is not for the file of a kind", "--kind FILE alone");
    const gap::Kind kind = kind_asked(request.kind);
    st::DescribedTest test;
    test.cases = request.cases > 0 ? request.cases : request.quick ? kQuickDescribed : kDescribed;
    test.seed = request.seed_given ? request.seed : fresh_seed();
    test.workers = request.workers;
    test.keep = request.keep;
    test.scratch = scratch_of(request);
    for (std::size_t k = 0; k < test.cases; ++k)
        refuse_foreign_files(test.scratch / fmt::format("case{:03}", k));
    test.done = [&](const st::DescribedCase& one, std::size_t done) {
        fmt::print(stderr, "{:>3}/{} {}\n", done, test.cases, st::described_line(one));
    };
    const auto cases = st::described_test(kind, test);
    if (request.scratch.empty() && !request.keep) std::filesystem::remove_all(test.scratch);
    fmt::print("{}", st::described_text(cases, test));
    return st::described_met(cases) ? 0 : 1;
}

/// Robots with a term that is in no catalogue; status 1 where one could not be recorded or analysed.
int beyond_test(const SelftestRequest& request) {
    namespace em = gap::emulate;
    em::RecordOptions options;
    options.tools = emulation_tools();
    options.seed = request.seed_given ? request.seed : fresh_seed();
    fmt::print(stderr, "seed {}\n", options.seed);
    options.brief = request.quick;
    options.keep = request.keep;
    std::vector<em::TermResult> results;
    for (std::size_t k = 0; k < (request.cases > 0 ? request.cases : kBeyond); ++k) {
        if (!request.kind.empty() && request.kind != em::drawn_term(k, options.seed).kind) continue;
        if (!request.only.empty() &&
            std::find(request.only.begin(), request.only.end(), k) == request.only.end())
            continue;
        options.scratch = scratch_of(request) / fmt::format("term{:02}", k);
        refuse_foreign_files(options.scratch);
        results.push_back(em::try_term(k, options));
        fmt::print(stderr, "{:>3} {}", k, em::term_line(results.back()));
    }
    if (results.empty()) throw InputError("", "gap selftest", "no case is of this kind and number");
    for (const em::TermResult& result : results)
        fmt::print("{}", em::term_line(result));
    fmt::print("{}", em::terms_text(results));
    return std::all_of(results.begin(), results.end(), [](const auto& r) { return r.error.empty(); }) ? 0 : 1;
}

int self_test(const SelftestRequest& request) {
    if (gap::names_kind_file(request.kind)) return described_self_test(request);
    const std::pair<const char*, bool> drawn[] = {
        {"--svg", !request.svg.empty()},    {"--full", request.full},
        {"--class", !request.of.empty()},   {"--pool", !request.pool.empty()},
        {"--draw-runs", request.draw_runs}, {"--ablation", request.ask_all},
        {"--power", request.power}};
    for (const auto& [option, given] : drawn)
        if (given && !request.grammar)
            throw InputError("", option, "is for cases drawn from the grammar", "--grammar");
    if (request.emulator) {
        const std::pair<const char*, bool> made[] = {{"--grammar", request.grammar},
                                                     {"--json", request.json},
                                                     {"--cases", request.cases > 0 && !request.beyond}};
        for (const auto& [option, given] : made)
            if (given) throw InputError("", option, "is for made experiments", "no --emulator");
        if (request.beyond && request.closed_loop)
            throw InputError("", "--closed-loop", "is for robots changed in secret", "no --beyond");
        return request.beyond ? beyond_test(request) : secret_test(request);
    }
    if (request.beyond) throw InputError("", "--beyond", "is for --emulator", "--emulator");
    if (request.closed_loop) throw InputError("", "--closed-loop", "is for --emulator", "--emulator");
    if (request.grammar) {
        if (request.quick) throw InputError("", "--quick", "is not for --grammar", "--cases N");
        if (request.full && request.cases > 0)
            throw InputError("", "--full", "is a number of cases, too", "no --cases");
        if (request.power && request.draw_runs)
            throw InputError("", "--draw-runs", "draws what --power varies", "one of the two");
        const std::uint64_t cases = request.cases > 0 ? request.cases : request.full ? kAllDrawn : kDrawn;
        const bool own = request.scratch.empty();
        const auto scratch = scratch_of(request);
        const int status =
            grammar_test({cases, request.seed_given ? request.seed : 0, request.only, request.workers,
                          request.kind, request.of, request.json, request.keep, request.draw_runs,
                          request.ask_all, request.power, scratch, request.svg, request.pool});
        if (own && !request.keep) std::filesystem::remove_all(scratch);
        return status;
    }
    st::RunOptions options;
    const bool own = request.scratch.empty();
    options.scratch = scratch_of(request);
    options.keep = request.keep;
    options.workers = request.workers;
    const Chosen chosen = chosen_plans(request);
    for (std::size_t k = 0; k < chosen.plans.size(); ++k)
        refuse_foreign_files(options.scratch / fmt::format("case{:03}", k));
    options.done = [&](std::size_t k, const st::Judged& judged, std::size_t done, std::size_t all) {
        fmt::print(stderr, "{:>3}/{} case {:<4}{}\n", done, all, chosen.number[k], st::case_line(judged));
    };
    const auto judged = st::run_cases(chosen.plans, options);
    if (own && !request.keep) std::filesystem::remove_all(options.scratch);
    fmt::print("{}\n",
               request.json ? st::report_json(judged, request.seed) : st::report_text(judged, request.seed));
    const auto wanted = st::requirements(judged);
    return std::all_of(wanted.begin(), wanted.end(), [](const st::Requirement& r) { return r.met(); }) ? 0
                                                                                                       : 1;
}

}  // namespace

void declare_gap_selftest(Command& gap, int& status) {
    Command* command = gap.add_subcommand("selftest", "Hide effects in made experiments and see what the "
                                                      "analysis says; status 1 when it misses its targets");
    auto request = std::make_shared<SelftestRequest>();
    command->add_option("--cases", request->cases, "how many (default: all, over 300; of --grammar 56)")
        ->check(count_up_to(kMostCases))
        ->type_name("N");
    command->add_flag("--grammar", request->grammar,
                      "cases drawn at random from a grammar of effects: unknown ones, near misses, known "
                      "ones, nothing; with a fresh seed, which is reported, unless --seed is given");
    command->add_flag("--full", request->full, "of --grammar: 1120 cases, 280 of each class (hours)");
    command
        ->add_option("--class", request->of,
                     "of --grammar: only these of its cases; noisy-input: nothing hidden, but what went in "
                     "was noted with errors")
        ->type_name("unknown|near-miss|known|null|noisy-input");
    command
        ->add_option("--pool", request->pool,
                     "of --grammar: count the cases of this --json result of an earlier run, in place of new "
                     "ones (may be repeated)")
        ->check(not_empty())
        ->type_name("FILE");
    command->add_flag("--draw-runs", request->draw_runs,
                      "of --grammar: how many runs an experiment has is drawn, too (power against runs)");
    command->add_flag(
        "--power", request->power,
        "of --grammar: each case is drawn with 24 runs or more and analysed with 4, 6, 8, 12, 16 "
        "and 24 of them: how often it is rightly called, against the number of runs");
    command->add_flag("--ablation", request->ask_all,
                      "of --grammar: every ground of a refused name is asked, also after one has spoken");
    command
        ->add_option("--svg", request->svg, "of --grammar: sensitivity curves and calibration as a picture")
        ->check(not_empty())
        ->type_name("FILE");
    command->add_option("--seed", request->seed, "of everything made up")
        ->check(count_up_to(kLargestSeed))
        ->type_name("N");
    command
        ->add_option("--kind", request->kind,
                     "cases of this kind only; the file of a kind of your own (NAME.toml): cases "
                     "drawn from its formulas")
        ->type_name("KIND");
    command->add_option("--case", request->only, "the case of this number only (may be repeated)")
        ->check(count_up_to(kMostCases))
        ->type_name("N");
    command->add_option("--workers", request->workers, "cases at a time")
        ->check(number_between(1, kMostWorkers))
        ->type_name("N");
    command->add_option("--scratch", request->scratch, "where the cases are written (a temporary folder)")
        ->check(not_empty())
        ->type_name("DIR");
    command->add_flag("--keep", request->keep, "leave the cases' folders");
    command->add_flag("--emulator", request->emulator,
                      "robots changed in secret and recorded on the emulator, in place of made experiments");
    command->add_flag("--beyond", request->beyond,
                      "of --emulator: terms that are in no catalogue act in the robot's world; are runs with "
                      "the overlay of what is learnt back at its floor? (--cases, default 40)");
    command->add_flag("--closed-loop", request->closed_loop,
                      "of --emulator: typed values and a recording no finer than the fitted model, in place "
                      "of values drawn from their published ranges with a fresh seed");
    command->add_flag("--quick", request->quick, "a small sample");
    command->add_flag("--json", request->json, "the result for programs");
    command->callback([command, request, &status] {
        request->seed_given = command->count("--seed") > 0;
        status = self_test(*request);
    });
}

}  // namespace puckloop::tools
