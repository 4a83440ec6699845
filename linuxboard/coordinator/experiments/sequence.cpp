#include "linuxboard/coordinator/experiments/sequence.h"

#include <algorithm>

namespace puckloop::coordinator {

namespace {

constexpr double kLongestStep = 1e6;  // s

constexpr Parameter kSequenceParameters[] = {
    {"order", "TAM00,TAM01", "the TAMs, in the order in which their tasks have to be done"},
    {"colors", "001900,000019", "of the LEDs while a TAM has its turn, rrggbb, one per TAM"},
    {"durations", "5,5", "s of work, one per TAM"},
    {"busy-color", "190000", "of the LEDs while a robot works"},
    {"dead-time", "10", "s between two rounds, all dark"},
    {"time-limit", "0", "s for the next task to be begun, or the round begins again; 0: none"},
    {"on-mistake", "restart", "a robot enters out of turn: restart the round, or ignore it"},
    {"rounds", "0", "the experiment ends behind so many; 0: never"},
};

}  // namespace

std::span<const Parameter> sequence_parameters() {
    return kSequenceParameters;
}

SequenceSettings read_sequence(const Parameters& parameters) {
    SequenceSettings settings;
    const std::vector<std::string> order = parameters.list("order");
    const std::vector<Color> colors = parameters.colors("colors");
    const std::vector<double> durations = parameters.numbers("durations", 0.0, kLongestStep);
    const std::string expected = std::to_string(order.size()) + ", one per TAM";
    for (std::size_t i = 0; i < order.size(); ++i) {
        const std::string& name = order[i];
        if (name.size() != 5 || !name.starts_with("TAM"))
            parameters.fail("order", "'" + name + "' is no TAM", "names such as TAM01");
        if (std::find(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(i), name) !=
            order.begin() + static_cast<std::ptrdiff_t>(i))
            parameters.fail("order", "has " + name + " twice", "each TAM once");
    }
    if (colors.size() != order.size())
        parameters.fail("colors", "has " + std::to_string(colors.size()) + " values", expected);
    if (durations.size() != order.size())
        parameters.fail("durations", "has " + std::to_string(durations.size()) + " values", expected);
    for (std::size_t i = 0; i < order.size(); ++i)
        settings.stages.push_back({order[i], colors[i], durations[i]});
    settings.busy = parameters.color("busy-color");
    settings.dead_time = parameters.number("dead-time", 0.0, kLongestStep);
    settings.time_limit = parameters.number("time-limit", 0.0, kLongestStep);
    const std::string mistake = parameters.text("on-mistake");
    if (mistake != "restart" && mistake != "ignore")
        parameters.fail("on-mistake", "'" + mistake + "' cannot be used", "restart or ignore");
    settings.restart = mistake == "restart";
    settings.rounds = parameters.whole("rounds");
    return settings;
}

/// One stage, at its TAM.
class SequenceController : public Controller {
  public:
    SequenceController(Sequence& sequence, std::size_t stage, Tam& tam)
        : sequence_(sequence), stage_(stage), tam_(tam) {}

    void step(double now) override {
        switch (state_.activity) {
        case Activity::Pause:  // just found
            if (tam_.robot())
                enter("occupied", Activity::Done, kOff);
            else
                enter("closed", Activity::Closed, kOff);
            break;
        case Activity::Closed:
            if (sequence_.open(stage_)) {
                enter("offer", Activity::Free, settings().color);
            } else if (tam_.robot()) {
                tam_.note("task", "mistake", "out of turn");
                tam_.write_robot(Sequence::kWrong);
                enter("out of turn", Activity::Done, kOff);
                sequence_.mistake(now);
            }
            break;
        case Activity::Free:
            if (!sequence_.open(stage_)) {
                enter("closed", Activity::Closed, kOff);
            } else if (tam_.robot() && tam_.shows(settings().color)) {
                attempt_ = sequence_.attempt();
                since_ = now;
                sequence_.work_begins();
                tam_.write_robot(Sequence::kWait);
                enter("work", Activity::Working, sequence_.settings().busy);
            }
            break;
        case Activity::Working:
            if (attempt_ != sequence_.attempt()) {
                tam_.note("task", "cancelled", "the round begins again");
                tam_.write_robot(Sequence::kWrong);
                enter("cancelled", Activity::Done, kOff);
            } else if (now - since_ >= settings().duration) {
                tam_.note("task", "done");
                tam_.write_robot(Sequence::kRight);
                enter("done", Activity::Done, kOff);
                sequence_.stage_done(now);
            } else if (!tam_.robot()) {
                tam_.note("task", "aborted");
                sequence_.work_aborted(now);
                enter("offer", Activity::Free, settings().color);
            }
            break;
        case Activity::Done:
            if (!tam_.robot()) enter("closed", Activity::Closed, kOff);
        }
    }

    State state() const override { return state_; }

  private:
    const SequenceSettings::Stage& settings() const { return sequence_.settings().stages[stage_]; }
    void enter(const char* name, Activity activity, Color color) {
        state_ = {name, activity};
        tam_.set_leds(color);
    }

    Sequence& sequence_;
    std::size_t stage_;
    Tam& tam_;
    State state_{"found", Activity::Pause};
    std::uint64_t attempt_ = 0;
    double since_ = 0;
};

std::unique_ptr<Controller> Sequence::attach(Tam& tam) {
    for (std::size_t i = 0; i < settings_.stages.size(); ++i)
        if (settings_.stages[i].tam == tam.name()) return std::make_unique<SequenceController>(*this, i, tam);
    return nullptr;
}

void Sequence::step(double now) {
    if (pause_ && now >= pause_until_) begin_round(now);
    const bool waits = !pause_ && stage_ > 0 && idle_since_ >= 0 && settings_.time_limit > 0;
    if (waits && now - idle_since_ >= settings_.time_limit) begin_round(now);
}

void Sequence::begin_round(double now) {
    stage_ = 0;
    pause_ = false;
    idle_since_ = now;
    ++attempt_;
}

void Sequence::stage_done(double now) {
    idle_since_ = now;
    if (++stage_ < settings_.stages.size()) return;
    ++rounds_;
    pause_ = true;
    pause_until_ = now + settings_.dead_time;
}

void Sequence::mistake(double now) {
    if (settings_.restart && !pause_) begin_round(now);
}

}  // namespace puckloop::coordinator
