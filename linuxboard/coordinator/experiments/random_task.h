#pragma once
// Every TAM offers tasks drawn at random, independent of the others. A robot that enters works for the task's
// duration; one that leaves before has aborted it. Behind either the TAM is dark for the dead time.

#include "base/random.h"
#include "linuxboard/coordinator/controller.h"
#include "linuxboard/coordinator/parameters.h"

#include <optional>
#include <string>
#include <vector>

namespace puckloop::coordinator {

std::span<const Parameter> random_task_parameters();

struct RandomTaskSettings {
    struct Task {
        std::string name;
        Color color;
        double duration = 0;                 ///< s
        std::optional<std::uint8_t> word{};  ///< to the robot that works
    };
    std::vector<Task> tasks;
    Color busy;            ///< while a robot works
    double dead_time = 0;  ///< s
    std::uint64_t seed = 1;
};

/// Throws InputError.
RandomTaskSettings read_random_task(const Parameters& parameters);

class RandomTask : public Experiment {
  public:
    explicit RandomTask(RandomTaskSettings settings) : settings_(std::move(settings)) {}
    std::unique_ptr<Controller> attach(Tam& tam) override;

  private:
    RandomTaskSettings settings_;
};

}  // namespace puckloop::coordinator
