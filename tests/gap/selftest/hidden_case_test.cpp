// The generator of hidden effects: what it writes the tool can read, and says nothing of what was hidden.

#include "gap/data/experiment.h"
#include "gap/reading/read_experiment.h"
#include "selftest/case_list.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <set>
#include <sstream>

using namespace puckloop::gap;
using namespace puckloop::gap::selftest;

namespace {

std::string content(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

}  // namespace

TEST_CASE("a whole self test has at least 300 cases and every kind of effect") {
    const auto plans = planned_cases(1, 0);
    CHECK(plans.size() >= 300);
    std::set<int> numbers;
    int unknown = 0, null = 0, twins = 0;
    for (const CasePlan& plan : plans) {
        null += plan.expect == Expect::NoEffect;
        unknown += plan.expect == Expect::Unexplained;
        twins += plan.expect == Expect::CannotTell;
        for (const std::size_t effect : plan.effects)
            numbers.insert(benches()[plan.bench]->effects()[effect].number);
    }
    CHECK(numbers.size() >= 40);
    CHECK(null >= 40);
    CHECK(unknown >= 40);
    CHECK(twins >= 9);
    CHECK(planned_cases(1, 30).size() == 30);
}

TEST_CASE("every case can be read, and its files do not tell what was hidden") {
    const auto folder = puckloop::tests::scratch_path("gap_hidden");
    const auto plans = planned_cases(3, 25);
    for (const CasePlan& plan : plans) {
        const HiddenCase made = make_case(plan);
        INFO(made.kind << (made.labels.empty() ? "" : made.labels.front()));
        std::filesystem::remove_all(folder);
        write_folder(made.experiment, folder);
        const Experiment experiment = read_experiment(folder);
        CHECK(experiment.runs.size() >= 3);
        CHECK(experiment.rows() <= 8000);
        const std::string toml = content(folder / "experiment.toml");
        for (const std::string& label : made.labels)
            CHECK(toml.find(label) == std::string::npos);
        const HiddenCase again = make_case(plan);
        CHECK(again.experiment.runs.front().columns.front().values ==
              made.experiment.runs.front().columns.front().values);
    }
    std::filesystem::remove_all(folder);
}

TEST_CASE("strengths are in units of the noise, not of what the tool finds") {
    for (std::size_t b = 0; b < benches().size(); ++b) {
        const auto effects = benches()[b]->effects();
        const std::size_t stride = effects.size() > 15 ? 5 : 2;  // the whole list takes a while
        for (std::size_t e = 0; e < effects.size(); e += stride) {
            const HiddenCase made = benches()[b]->make({b, {e}, Strength::Medium, Expect::Named, 5});
            INFO(made.kind << ": " << made.labels.front() << " " << made.ratio);
            CHECK(made.ratio > 0.05);  // what chance decides has levels of its own
            CHECK(made.ratio < 20);
        }
    }
}
