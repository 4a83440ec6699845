#pragma once
// The experiments there are, by name. A new one gets a line in the table of experiments.cpp.

#include "linuxboard/coordinator/controller.h"
#include "linuxboard/coordinator/parameters.h"

#include <memory>
#include <span>

namespace puckloop::coordinator {

struct ExperimentKind {
    const char* name;
    const char* help;
    std::span<const Parameter> (*parameters)();
    /// Throws InputError.
    std::unique_ptr<Experiment> (*make)(const Parameters& parameters);
};

std::span<const ExperimentKind> experiments();
/// nullptr if there is none of that name.
const ExperimentKind* find_experiment(std::string_view name);

}  // namespace puckloop::coordinator
