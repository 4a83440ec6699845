#include "linuxboard/coordinator/experiments/experiments.h"

#include "linuxboard/coordinator/experiments/random_task.h"
#include "linuxboard/coordinator/experiments/sequence.h"

namespace puckloop::coordinator {

namespace {

const ExperimentKind kExperiments[] = {
    {"random-task", "each TAM offers tasks drawn at random", random_task_parameters,
     [](const Parameters& parameters) -> std::unique_ptr<Experiment> {
         return std::make_unique<RandomTask>(read_random_task(parameters));
     }},
    {"sequence", "tasks at several TAMs that have to be done in order", sequence_parameters,
     [](const Parameters& parameters) -> std::unique_ptr<Experiment> {
         return std::make_unique<Sequence>(read_sequence(parameters));
     }},
};

}  // namespace

std::span<const ExperimentKind> experiments() {
    return kExperiments;
}

const ExperimentKind* find_experiment(std::string_view name) {
    for (const ExperimentKind& kind : kExperiments)
        if (name == kind.name) return &kind;
    return nullptr;
}

}  // namespace puckloop::coordinator
