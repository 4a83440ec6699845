#pragma once
// From a rig and its list of effects to cases: how strong an effect must be is found by bisection on the
// exact tables, never by asking the tool.

#include "selftest/benches/hidden_case.h"
#include "selftest/benches/rig.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace puckloop::gap::selftest {

/// What can be hidden. `hide` turns knobs by an amount of 0..`most` (with a random sign if `either_sign`) and
/// tells the true parameters; its random stream fixes directions and signs of arrays.
template <class Knobs>
struct HiddenEffect {
    int number;
    const char* label;
    double most;
    bool either_sign;
    std::function<std::vector<Truth>(Knobs&, double amount, RandomStream)> hide;
    std::optional<std::array<double, 3>> levels{};  ///< amounts at low, medium, high, for what chance decides
    const char* variant = "";
    int instead_of = 0;
    const char* called = "";  ///< in the catalogue, where several of its effects share the number
};

/// The plainest thing to hide: one knob turned by the amount, which is the parameter's value where there is
/// one.
template <class Knobs>
auto turned(double Knobs::*knob, std::string parameter = {}) {
    return [knob, parameter = std::move(parameter)](Knobs& knobs, double amount, const RandomStream&) {
        knobs.*knob = amount;
        return parameter.empty() ? std::vector<Truth>{} : std::vector<Truth>{{parameter, amount}};
    };
}

/// Every knob of an array drawn by itself; its parameter is numbered from `first` and has `rest(i)` besides.
template <class Array, class Draw, class Rest = double (*)(std::size_t)>
std::vector<Truth> scattered(
    Array& knobs, const char* parameter, const Draw& draw, std::size_t first = 0,
    const Rest& rest = [](std::size_t) { return 0.0; }) {
    std::vector<Truth> truths;
    for (std::size_t i = 0; i < knobs.size(); ++i) {
        knobs[i] = draw();
        truths.push_back({fmt::format("{}{}", parameter, i + first), rest(i) + knobs[i]});
    }
    return truths;
}

template <class Knobs>
class BenchOf : public Bench {
  public:
    BenchOf(const Rig<Knobs>& rig, std::vector<HiddenEffect<Knobs>> effects)
        : rig_(rig), effects_(std::move(effects)) {}

    const char* kind() const override { return rig_.kind; }
    std::vector<EffectInfo> effects() const override {
        std::vector<EffectInfo> list;
        for (const auto& effect : effects_)
            list.push_back({effect.number, effect.label, effect.instead_of, effect.variant});
        return list;
    }
    WrittenExperiment exact(std::uint64_t seed) const override { return rig_.exact(Knobs{}, seed, ""); }
    void measure(WrittenExperiment& experiment, const NoiseStyle& style, std::uint64_t seed) const override {
        rig_.measure(experiment, Knobs{}, style, seed);
        RandomStream holes(seed, "holes");
        for (WrittenRun& run : experiment.runs)
            punch_holes(run, style, experiment.kind == "motion", holes);
    }
    std::vector<NoiseFloor> floor() const override { return rig_.floor; }
    std::vector<WrittenExperiment> examples(std::size_t index, std::uint64_t seed) const override {
        constexpr int kDraws = 9;  // as many as sensors, and one
        std::vector<WrittenExperiment> list;
        const auto& effect = effects_[index];
        if (*effect.variant != '\0') return list;
        for (int draw = 0; draw < kDraws; ++draw) {
            Knobs knobs;
            effect.hide(knobs, effect.most / 2, RandomStream(seed, fmt::format("example {}", draw)));
            list.push_back(rig_.exact(knobs, seed, ""));
            if (draw == 1 && distance_in_noise(list[0], list[1], rig_.floor) == 0.0) {
                list.pop_back();
                break;
            }
        }
        return list;
    }
    HiddenCase make(const CasePlan& plan) const override {
        HiddenCase made;
        made.kind = rig_.kind;
        made.expect = plan.expect;
        made.strength = plan.strength;
        const std::string variant =
            plan.effects.empty() ? plan.variant : effects_[plan.effects.front()].variant;
        Knobs knobs;
        const WrittenExperiment rest =
            plan.effects.empty() ? WrittenExperiment{} : rig_.exact(Knobs{}, plan.seed, variant);
        made.ratio = plan.effects.empty() ? 0.0 : INFINITY;
        for (const std::size_t index : plan.effects) {
            const auto& effect = effects_[index];
            const RandomStream shape(plan.seed, fmt::format("shape {}", effect.label));
            const auto [amount, ratio] = amount_for(effect, plan, variant, shape, rest);
            for (Truth& truth : effect.hide(knobs, amount, shape))
                made.truths.push_back(std::move(truth));
            made.ratio = std::min(made.ratio, ratio);
            made.labels.emplace_back(effect.label);
            if (effect.number != 0) {
                made.numbers.push_back(effect.number);
                made.called.emplace_back(effect.called);
            }
            if (effect.instead_of != 0) {
                made.numbers.push_back(effect.instead_of);
                made.called.emplace_back();
            }
        }
        RandomStream random(plan.seed, "noise style");
        const NoiseStyle style = NoiseStyle::draw(random);
        made.experiment = repeated(plan.seed, plan.least_runs,
                                   [&](std::uint64_t seed) { return rig_.exact(knobs, seed, variant); });
        rig_.measure(made.experiment, knobs, style, plan.seed);
        RandomStream holes(plan.seed, "holes");
        for (WrittenRun& run : made.experiment.runs)
            punch_holes(run, style, made.kind == "motion", holes);
        return made;
    }

  private:
    double ratio_at(const HiddenEffect<Knobs>& effect, double amount, const CasePlan& plan,
                    const std::string& variant, const RandomStream& shape,
                    const WrittenExperiment& rest) const {
        Knobs knobs;
        effect.hide(knobs, amount, shape);
        const double moved = distance_in_noise(rig_.exact(knobs, plan.seed, variant), rest, rig_.floor);
        return std::hypot(moved, rig_.growth(knobs, plan.seed, variant));
    }
    std::pair<double, double> amount_for(const HiddenEffect<Knobs>& effect, const CasePlan& plan,
                                         const std::string& variant, const RandomStream& shape,
                                         const WrittenExperiment& rest) const {
        RandomStream side(plan.seed, fmt::format("sign {}", effect.label));
        const double sign = effect.either_sign && side.uniform() < 0.5 ? -1.0 : 1.0;
        if (effect.levels && plan.asked <= 0) {
            const double amount = (*effect.levels)[plan.strength == Strength::Low      ? 0
                                                   : plan.strength == Strength::Medium ? 1
                                                                                       : 2];
            return {sign * amount, ratio_at(effect, sign * amount, plan, variant, shape, rest)};
        }
        const double asked = plan.asked > 0 ? plan.asked : asked_ratio(plan.strength);
        double low = 0.0, high = effect.most;
        double reached = ratio_at(effect, sign * high, plan, variant, shape, rest);
        if (reached <= asked) return {sign * high, reached};
        constexpr int kHalvings = 18;
        constexpr double kNearEnough = 0.02;
        for (int k = 0; k < kHalvings && std::abs(reached - asked) > kNearEnough * asked; ++k) {
            const double middle = (low + high) / 2;
            reached = ratio_at(effect, sign * middle, plan, variant, shape, rest);
            (reached > asked ? high : low) = middle;
            if (std::abs(reached - asked) <= kNearEnough * asked) return {sign * middle, reached};
        }
        return {sign * high, ratio_at(effect, sign * high, plan, variant, shape, rest)};
    }

    const Rig<Knobs>& rig_;
    std::vector<HiddenEffect<Knobs>> effects_;
};

}  // namespace puckloop::gap::selftest
