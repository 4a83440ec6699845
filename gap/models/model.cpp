#include "gap/models/model.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "physics/description/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

/// "proximity.gain3" is one of "proximity.gain".
bool is_numbered(std::string_view name, std::string_view group) {
    return name.size() > group.size() && name.starts_with(group) &&
           name.find_first_not_of("0123456789", group.size()) == std::string_view::npos;
}

/// A nominal number far outside anything built gives no prediction to start from.
void check_finite(const Experiment& experiment, const Model& model) {
    constexpr double kLargest = 1e11;  // clocks may count from 1970, in seconds
    const Prediction prediction = model.predicted(model.neutral());
    for (std::size_t o = 0; o < prediction.size(); ++o)
        for (const double mean : prediction[o].mean)
            if (!(std::abs(mean) < kLargest))
                throw InputError((experiment.folder / "experiment.toml").string(), "",
                                 fmt::format("the simulation gives {} = {:g} with these [nominal] numbers",
                                             model.observables()[o].name, mean),
                                 "numbers of a robot that can be built");
}

std::unique_ptr<Model> make_unchecked(const Experiment& experiment, MotionView view) {
    if (experiment.kind == Kind::Motion) return make_motion_model(experiment, view);
    static const std::map<Kind::Builtin, std::unique_ptr<Model> (*)(const Experiment&)> others{
        {Kind::Proximity, make_proximity_model},         {Kind::Rab, make_rab_model},
        {Kind::Microphone, make_microphone_model},       {Kind::Ground, make_ground_model},
        {Kind::Accelerometer, make_accelerometer_model}, {Kind::Timing, make_timing_model},
        {Kind::Described, make_described_model}};
    return others.at(experiment.kind)(experiment);
}

}  // namespace

double shown(const Predicted& predicted, std::size_t i) {
    const double mean = predicted.mean[i];
    if (predicted.floor > 0.0 && mean < predicted.floor) return 0.0;
    return predicted.ceiling > 0.0 ? std::min(mean, predicted.ceiling) : mean;
}

std::optional<std::size_t> Model::find(std::string_view name) const {
    for (std::size_t i = 0; i < parameters_.size(); ++i)
        if (parameters_[i].name == name) return i;
    return std::nullopt;
}

std::vector<std::size_t> Model::matching(std::string_view pattern) const {
    std::vector<std::size_t> found;
    if (const auto other = pattern.find('|'); other != std::string_view::npos) {
        found = matching(pattern.substr(0, other));
        return found.empty() ? matching(pattern.substr(other + 1)) : found;
    }
    const bool many = pattern.ends_with('*');
    if (many) pattern.remove_suffix(1);
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
        const std::string_view name = parameters_[i].name;
        if (many ? is_numbered(name, pattern) : name == pattern) found.push_back(i);
    }
    return found;
}

std::vector<double> Model::neutral() const {
    std::vector<double> values;
    for (const auto& parameter : parameters_)
        values.push_back(parameter.neutral);
    return values;
}

Prediction Model::predicted(const std::vector<double>& values) const {
    Prediction out;
    predict(values, out);
    return out;
}

std::size_t Model::add(std::string name, std::string unit, double neutral) {
    parameters_.push_back({std::move(name), std::move(unit), neutral});
    return parameters_.size() - 1;
}

void Model::apply_nominal(const Experiment& experiment) {
    const std::string file = (experiment.folder / "experiment.toml").string();
    for (const auto& [name, value] : experiment.nominal) {
        bool known = false;
        for (auto& parameter : parameters_) {
            const bool of_group =
                is_numbered(parameter.name, name) && !experiment.nominal.contains(parameter.name);
            if (parameter.name != name && !of_group) continue;
            parameter.neutral = value;
            known = true;
        }
        int index = -1;
        if (known || physics::find_parameter(name, index) != nullptr)
            continue;  // of the robot, without say here
        std::vector<std::string_view> names;
        for (const auto& parameter : parameters_)
            names.emplace_back(parameter.name);
        for (const auto& parameter : physics::parameter_table())
            names.emplace_back(parameter.name);
        throw InputError(file, "",
                         fmt::format("[nominal] names no parameter of kind {}: {}{}",
                                     kind_name(experiment.kind), name, did_you_mean(name, names)),
                         "one of docs/gap.md or of `puckloop run --list-parameters`");
    }
}

std::unique_ptr<Model> make_model(const Experiment& experiment, MotionView view) {
    auto model = make_unchecked(experiment, view);
    check_finite(experiment, *model);
    return model;
}

}  // namespace puckloop::gap
