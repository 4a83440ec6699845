#pragma once
// The example of docs/coordinator.md, which has the same text.

#include "linuxboard/coordinator/experiments/experiments.h"

namespace puckloop::coordinator::test {

// begin
class Visits : public Controller {
  public:
    Visits(Tam& tam, Color color, int& total) : tam_(tam), color_(color), total_(total) {}
    void step(double /*now*/) override {  // every 10 ms, from the first report on
        if (tam_.robot() && !inside_) {
            tam_.note("visit", std::to_string(++total_));  // a line of the table
            tam_.write_robot(0x42);                        // to the robot, by infra-red, while it is inside
        }
        inside_ = tam_.robot();
        tam_.set_leds(inside_ ? color_ : kOff);  // a request: repeated until a report has it
    }
    State state() const override {  // the bar in the picture
        return inside_ ? State{"visit", Activity::Working} : State{"empty", Activity::Free};
    }

  private:
    Tam& tam_;
    Color color_;
    int& total_;
    bool inside_ = false;
};

class VisitsExperiment : public Experiment {
  public:
    explicit VisitsExperiment(const Parameters& parameters)
        : color_(parameters.color("visit-color")), most_(parameters.whole("visits")) {}
    std::unique_ptr<Controller> attach(Tam& tam) override {
        return std::make_unique<Visits>(tam, color_, total_);
    }
    bool finished() const override { return most_ != 0 && total_ >= static_cast<int>(most_); }

  private:
    Color color_;
    std::uint64_t most_;
    int total_ = 0;
};

constexpr Parameter kVisits[] = {{"visit-color", "190000", "of the LEDs while a robot is inside"},
                                 {"visits", "0", "the experiment ends behind so many; 0: never"}};

// Its line in the table of experiments.cpp.
const ExperimentKind kVisitsKind{"visits", "lights TAMs that are visited",
                                 [] { return std::span<const Parameter>(kVisits); },
                                 [](const Parameters& parameters) -> std::unique_ptr<Experiment> {
                                     return std::make_unique<VisitsExperiment>(parameters);
                                 }};
// end

}  // namespace puckloop::coordinator::test
