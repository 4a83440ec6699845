// A small self test: strong effects of the cheap kinds are found by name, and nothing where nothing is
// hidden.

#include "selftest/run_cases.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <string>

using namespace puckloop::gap::selftest;

namespace {

CasePlan plan_of(const std::string& kind, const std::string& label, Strength strength, Expect expect) {
    for (std::size_t b = 0; b < benches().size(); ++b) {
        if (benches()[b]->kind() != kind) continue;
        const auto effects = benches()[b]->effects();
        for (std::size_t e = 0; e < effects.size(); ++e)
            if (effects[e].label == label) return {b, {e}, strength, expect, 17};
        if (label.empty()) return {b, {}, strength, expect, 17};
    }
    FAIL("no such case: " + kind + ", " + label);
    return {};
}

}  // namespace

TEST_CASE("a strong effect is named, and nothing where nothing is hidden") {
    const std::vector<CasePlan> plans{
        plan_of("ground", "lag", Strength::High, Expect::Named),
        plan_of("ground", "pitch while starting", Strength::High, Expect::Named),
        plan_of("microphone", "gain spread", Strength::High, Expect::Named),
        plan_of("microphone", "fall with distance", Strength::High, Expect::Named),
        plan_of("ground", "", Strength::None, Expect::NoEffect),
        plan_of("microphone", "", Strength::None, Expect::NoEffect),
    };
    RunOptions options;
    options.scratch = puckloop::tests::scratch_path("gap_quick");
    const auto judged = run_cases(plans, options);
    std::filesystem::remove_all(options.scratch);
    for (const Judged& j : judged) {
        INFO(j.kind << " " << (j.labels.empty() ? "" : j.labels.front()) << ": said " << j.said << " "
                    << (j.names.empty() ? "" : j.names.front()) << " " << j.error);
        if (j.expect == Expect::Named)
            CHECK(j.first_right);
        else
            CHECK(j.said == "no_effect");
    }
}
