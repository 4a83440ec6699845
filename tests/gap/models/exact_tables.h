#pragma once
// The generator's tables without noise, as the forward models see them: two programs that share no formula,
// held to each other.

#include "gap/data/experiment.h"
#include "gap/models/model.h"
#include "gap/reading/read_experiment.h"
#include "selftest/benches/benches.h"
#include "tests/kit/scratch.h"

#include <cmath>
#include <map>
#include <memory>
#include <string>

namespace puckloop::gap {

/// An experiment with knobs turned, read back from its folder, and its model.
template <class Knobs>
class Exact {
  public:
    Exact(const selftest::Rig<Knobs>& rig, const Knobs& knobs, const std::string& name,
          MotionView view = MotionView::Robot) {
        WrittenExperiment table = rig.exact(knobs, 5, "");
        table.instruments.clear();
        const auto folder = tests::scratch_path("exact_" + name);
        write_folder(table, folder);
        experiment_ = read_experiment(folder);
        std::filesystem::remove_all(folder);
        model_ = make_model(experiment_, view);
    }
    const Model& model() const { return *model_; }

    /// Root mean square of measured minus predicted with these parameters, observable's unit.
    double misfit(const std::string& observable, const std::map<std::string, double>& parameters) const {
        auto values = model_->neutral();
        for (const auto& [name, value] : parameters)
            values.at(*model_->find(name)) = value;
        Prediction prediction;
        model_->predict(values, prediction);
        for (std::size_t o = 0; o < prediction.size(); ++o) {
            const Observable& one = model_->observables()[o];
            if (one.name != observable) continue;
            double sum = 0.0;
            for (std::size_t i = 0; i < one.y.size(); ++i)
                sum += std::pow(one.y[i] - prediction[o].mean[i], 2);
            return std::sqrt(sum / static_cast<double>(one.y.size()));
        }
        return NAN;
    }

  private:
    Experiment experiment_;
    std::unique_ptr<Model> model_;
};

}  // namespace puckloop::gap
