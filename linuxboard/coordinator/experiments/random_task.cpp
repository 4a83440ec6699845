#include "linuxboard/coordinator/experiments/random_task.h"

namespace puckloop::coordinator {

namespace {

constexpr double kLongestTask = 1e6;  // s

constexpr Parameter kTaskParameters[] = {
    {"tasks", "green,blue", "names of the tasks, drawn with equal chances"},
    {"colors", "001900,000019", "of the LEDs while a task is offered, rrggbb, one per task"},
    {"durations", "5,20", "s of work, one per task"},
    {"words", "none", "bytes, 0 to 255, one per task: sent by infra-red to the robot that works; or none"},
    {"busy-color", "190000", "of the LEDs while a robot works"},
    {"dead-time", "10", "s dark behind a task"},
    {"seed", "1", "of the draws; each TAM draws for itself"},
};

class RandomTaskController : public Controller {
  public:
    RandomTaskController(const RandomTaskSettings& settings, Tam& tam)
        : settings_(settings), tam_(tam), random_(settings.seed, "random-task/" + tam.name()) {}

    void step(double now) override {
        switch (state_.activity) {
        case Activity::Closed:  // just found, LEDs unknown
            if (tam_.shows(kOff)) offer();
            break;
        case Activity::Free:
            if (tam_.shows(task_->color) && tam_.robot()) enter(Activity::Working, now, settings_.busy);
            break;
        case Activity::Working:
            if (now - since_ >= task_->duration) {
                tam_.note("task", "done", task_->name);
                enter(Activity::Done, now, kOff);
            } else if (!tam_.robot()) {
                tam_.note("task", "aborted", task_->name);
                enter(Activity::Pause, now, kOff);
            }
            break;
        case Activity::Done:
            if (!tam_.robot()) enter(Activity::Pause, now, kOff);
            break;
        case Activity::Pause:
            if (now - since_ >= settings_.dead_time) offer();
        }
    }

    State state() const override { return state_; }

  private:
    void offer() {
        task_ = &settings_.tasks[random_.below(settings_.tasks.size())];
        state_ = {"offer " + task_->name, Activity::Free};
        tam_.set_leds(task_->color);
    }
    void enter(Activity activity, double now, Color color) {
        since_ = now;
        state_ = {std::string(name_of(activity)), activity};
        if (activity == Activity::Working) {
            state_.name = "work on " + task_->name;
            if (task_->word) tam_.write_robot(*task_->word);
        }
        tam_.set_leds(color);
    }

    const RandomTaskSettings& settings_;
    Tam& tam_;
    RandomStream random_;
    const RandomTaskSettings::Task* task_ = nullptr;
    State state_{"found", Activity::Closed};
    double since_ = 0;
};

}  // namespace

std::span<const Parameter> random_task_parameters() {
    return kTaskParameters;
}

RandomTaskSettings read_random_task(const Parameters& parameters) {
    RandomTaskSettings settings;
    const std::vector<std::string> names = parameters.list("tasks");
    const std::vector<Color> colors = parameters.colors("colors");
    const std::vector<double> durations = parameters.numbers("durations", 0.0, kLongestTask);
    const std::string expected = std::to_string(names.size()) + ", one per task";
    if (colors.size() != names.size())
        parameters.fail("colors", "has " + std::to_string(colors.size()) + " values", expected);
    if (durations.size() != names.size())
        parameters.fail("durations", "has " + std::to_string(durations.size()) + " values", expected);
    for (std::size_t i = 0; i < names.size(); ++i)
        settings.tasks.push_back({names[i], colors[i], durations[i]});
    if (parameters.list("words") != std::vector<std::string>{"none"}) {
        const std::vector<double> words = parameters.numbers("words", 0, 255);
        if (words.size() != names.size())
            parameters.fail("words", "has " + std::to_string(words.size()) + " values", expected);
        for (std::size_t i = 0; i < words.size(); ++i) {
            settings.tasks[i].word = static_cast<std::uint8_t>(words[i]);
            if (*settings.tasks[i].word != words[i])
                parameters.fail("words", "has a fraction", "whole numbers, 0 to 255");
        }
    }
    settings.busy = parameters.color("busy-color");
    settings.dead_time = parameters.number("dead-time", 0.0, kLongestTask);
    settings.seed = parameters.whole("seed");
    return settings;
}

std::unique_ptr<Controller> RandomTask::attach(Tam& tam) {
    return std::make_unique<RandomTaskController>(settings_, tam);
}

}  // namespace puckloop::coordinator
