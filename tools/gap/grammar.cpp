// puckloop gap selftest --grammar: cases drawn at random, with a seed that is new at each full run.

#include "base/error.h"
#include "selftest/grammar/curves.h"
#include "tools/gap/folders.h"
#include "tools/gap/subcommands.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <random>
#include <sstream>

namespace puckloop::tools {

namespace {

namespace gr = gap::selftest::grammar;

std::optional<gr::Class> class_named(const std::string& name) {
    if (name.empty()) return std::nullopt;
    if (name == "near-miss") return gr::Class::NearMiss;
    if (name == "noisy-input") return gr::Class::NoisyInput;
    for (const gr::Class of : {gr::Class::Unknown, gr::Class::Known, gr::Class::Null})
        if (name == gr::class_name(of)) return of;
    throw InputError("", "--class", fmt::format("no class '{}'", name),
                     "unknown, near-miss, known, null or noisy-input");
}

}  // namespace

std::uint64_t fresh_seed() {
    constexpr std::uint64_t kReadable = 1'000'000'000;
    std::random_device device;
    return (static_cast<std::uint64_t>(device()) << 32U | device()) % kReadable + 1;
}

namespace {

std::vector<gr::Outcome> drawn(const GrammarRequest& request, std::uint64_t seed) {
    gr::Drawing drawing;
    drawing.cases = request.cases;
    drawing.seed = seed;
    drawing.kind = request.kind;
    drawing.of = class_named(request.of);
    drawing.draw_runs = request.draw_runs;
    drawing.ask_all = request.ask_all;
    drawing.only = request.only;
    drawing.scratch = request.scratch;
    drawing.workers = request.workers;
    drawing.keep = request.keep;
    for (std::size_t n = 0; n < drawing.cases; ++n)
        refuse_foreign_files(drawing.scratch / fmt::format("case{:04}", n));
    fmt::print(stderr, "seed {}\n", drawing.seed);
    drawing.done = [](const gr::Outcome& outcome, std::size_t done, std::size_t all) {
        fmt::print(stderr, "{:>4}/{} {}\n", done, all, gr::outcome_line(outcome));
    };
    auto cases = request.power ? gr::run_power(drawing) : gr::run_drawn(drawing);
    if (cases.empty())
        throw InputError("", "gap selftest", "no drawn case is of this kind, class and number",
                         "--cases 28 or more");
    return cases;
}

std::vector<gr::Outcome> pooled(const std::vector<std::string>& files) {
    std::vector<gr::Outcome> cases;
    for (const std::string& file : files) {
        std::ifstream in(file);
        std::stringstream text;
        text << in.rdbuf();
        if (!in) throw InputError(file, "", "cannot be read", "a file");
        for (gr::Outcome& one : gr::outcomes_from_json(text.str(), file))
            cases.push_back(std::move(one));
    }
    return cases;
}

}  // namespace

int grammar_test(const GrammarRequest& request) {
    const std::uint64_t seed = request.seed == 0 ? fresh_seed() : request.seed;
    const auto cases = request.pool.empty() ? drawn(request, seed) : pooled(request.pool);
    if (!request.svg.empty()) {
        write_beside(request.svg, request.power ? gr::power_svg(cases) : gr::curves_svg(cases));
        put_in_place(request.svg);
    }
    const std::string seeds = request.pool.empty() ? std::to_string(seed) : "of each file";
    fmt::print("{}\n", request.json    ? gr::rates_json(cases, seed)
                       : request.power ? gr::power_text(cases, seeds)
                                       : gr::rates_text(cases, seeds));
    if (request.power) return 0;  // the targets are asked of whole experiments
    const auto wanted = gr::targets(cases);
    return std::all_of(wanted.begin(), wanted.end(), [](const gr::Target& target) { return target.met(); })
               ? 0
               : 1;
}

}  // namespace puckloop::tools
