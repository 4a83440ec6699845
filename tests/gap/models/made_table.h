#pragma once
// Experiments of one run, made in memory, for the tests of the forward models.

#include "gap/models/model.h"

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::gap::tests {

using Table = std::map<std::string, std::vector<double>, std::less<>>;

inline Experiment experiment_of(Kind kind, Table columns, std::map<std::string, double> nominal = {}) {
    Experiment experiment;
    experiment.kind = kind;
    experiment.nominal = std::move(nominal);
    Run run;
    run.name = "run";
    run.rows = columns.begin()->second.size();
    run.columns = std::move(columns);
    experiment.runs.push_back(std::move(run));
    return experiment;
}

/// What the model says with these parameters off their neutral values.
inline Prediction predicted(const Model& model, const std::map<std::string, double>& changed = {}) {
    std::vector<double> values = model.neutral();
    for (const auto& [name, value] : changed)
        values.at(*model.find(name)) = value;
    Prediction prediction;
    model.predict(values, prediction);
    return prediction;
}

}  // namespace puckloop::gap::tests
