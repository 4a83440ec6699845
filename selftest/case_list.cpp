#include "selftest/case_list.h"

#include "base/random.h"
#include "selftest/benches/benches.h"

#include <algorithm>

namespace puckloop::gap::selftest {

namespace {

constexpr int kRepeatsOfAnEffect = 2;  // at each strength
constexpr int kNullsOfAKind = 8;
constexpr int kUnknownsOfAnEffect = 2;  // at medium and at high strength each
constexpr int kTwinsOfAnEffect = 3;
constexpr std::size_t kPairsOfAKind = 4;
constexpr const char* kLawVariant = "power law";  // of the proximity sensors; other kinds do not know it

}  // namespace

double asked_ratio(Strength strength) {
    switch (strength) {
    case Strength::Low:
        return 0.25;
    case Strength::Medium:
        return 1.0;
    case Strength::High:
        return 4.0;
    default:
        return 0.0;
    }
}

const char* strength_name(Strength strength) {
    constexpr const char* names[] = {"none", "low", "medium", "high"};
    return names[static_cast<int>(strength)];
}

const char* expect_name(Expect expect) {
    constexpr const char* names[] = {"named", "no_effect", "unexplained", "cannot_tell"};
    return names[static_cast<int>(expect)];
}

const std::vector<std::unique_ptr<Bench>>& benches() {
    static const auto list = [] {
        std::vector<std::unique_ptr<Bench>> all;
        all.push_back(motion_bench());
        all.push_back(proximity_bench());
        all.push_back(rab_bench());
        all.push_back(microphone_bench());
        all.push_back(ground_bench());
        all.push_back(accelerometer_bench());
        all.push_back(timing_bench());
        return all;
    }();
    return list;
}

std::vector<CasePlan> planned_cases(std::uint64_t seed, std::size_t cases) {
    RandomStream random(seed, "self test cases");
    std::vector<CasePlan> plans;
    const auto add = [&](std::size_t bench, std::vector<std::size_t> effects, Strength strength,
                         Expect expect) {
        plans.push_back({bench, std::move(effects), strength, expect, random.next()});
    };
    for (std::size_t b = 0; b < benches().size(); ++b) {
        const auto effects = benches()[b]->effects();
        std::vector<std::size_t> known;
        for (std::size_t e = 0; e < effects.size(); ++e) {
            if (effects[e].instead_of != 0) {
                for (int k = 0; k < kTwinsOfAnEffect; ++k)
                    add(b, {e}, k == 0 ? Strength::Medium : Strength::High, Expect::CannotTell);
            } else if (effects[e].number == 0) {
                for (int k = 0; k < kUnknownsOfAnEffect; ++k)
                    for (const Strength s : {Strength::Medium, Strength::High})
                        add(b, {e}, s, Expect::Unexplained);
            } else {
                known.push_back(e);
                for (int k = 0; k < kRepeatsOfAnEffect; ++k)
                    for (const Strength s : {Strength::Low, Strength::Medium, Strength::High})
                        add(b, {e}, s, Expect::Named);
            }
        }
        for (int k = 0; k < kNullsOfAKind; ++k) {
            add(b, {}, Strength::None, Expect::NoEffect);
            if (k % 2 == 1) plans.back().variant = kLawVariant;
        }
        for (std::size_t k = 0; k < kPairsOfAKind && known.size() > 2; ++k) {
            const std::size_t one = known[random.below(known.size())];
            std::size_t other = one;
            while (effects[other].number == effects[one].number ||
                   effects[other].variant != effects[one].variant)
                other = known[random.below(known.size())];
            add(b, {one, other}, Strength::High, Expect::Named);
        }
    }
    if (cases == 0 || cases >= plans.size()) return plans;
    std::vector<CasePlan> thinned;
    for (std::size_t k = 0; k < cases; ++k)
        thinned.push_back(plans[k * plans.size() / cases]);
    return thinned;
}

HiddenCase make_case(const CasePlan& plan) {
    return benches()[plan.bench]->make(plan);
}

}  // namespace puckloop::gap::selftest
