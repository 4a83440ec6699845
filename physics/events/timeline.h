#pragma once
// When what happens to a world: events of the plan, conditions that come true, commands that come in.
//
// Step k is the world's state at k ms. What is done to bodies, floor and light is done at the first step at
// or after its time, behind the dynamics and before the sensors look. A condition is looked at after that;
// when it holds, its event is due one step later, plus its delay; a command that has come in by then
// likewise. Signals to a board (selector, reset button, remote control) and datagrams leave at their exact
// time, at the earliest 1 us.

#include "physics/events/command_source.h"
#include "physics/events/journal.h"
#include "physics/events/scene.h"
#include "physics/events/watches.h"

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::physics {

enum class BoardInput : std::uint8_t { Selector, Reset, Remote };

/// A change of a board's input.
struct BoardSignal {
    cosim::Time time = 0;
    std::size_t robot = 0;
    BoardInput input = BoardInput::Selector;
    double value = 0.0;
};

/// What Send sends.
struct Datagram {
    cosim::Time time = 0;
    std::uint32_t address = 0;  ///< of the computer
    std::uint16_t port = 0;
    std::string text{};
};

class Timeline {
  public:
    /// `model` and `commands` (may be null) must outlive it. Throws RunError if the journal cannot be
    /// written.
    Timeline(WorldModel& model, EventPlan plan, CommandSource* commands);

    /// False: nothing will ever happen, and nobody need ask.
    bool active() const { return plan_.any(); }
    const EventPlan& plan() const { return plan_; }

    void board_signal(std::size_t robot, std::uint16_t id, double value) {
        watches_.board_signal(robot, id, value);
    }
    /// Between the model's move_bodies() and its sense(). Appends one line for the log per event.
    void at_step(std::vector<std::string>& log);
    /// After it: signals up to a step later, in order of time.
    void take_signals(std::vector<BoardSignal>& signals);
    /// The same of datagrams.
    std::vector<Datagram> take_datagrams() { return std::exchange(datagrams_, {}); }
    /// No signal and no datagram leaves before this.
    cosim::Time next_signal() const;

    /// The run has ended: whoever still waits for a reply gets one.
    void end();
    const Journal& journal() const { return journal_; }

  private:
    struct Due {
        cosim::Time time = 0;
        std::size_t event = 0;  ///< or Journal::kLive
        std::uint64_t serial = 0;
        friend auto operator<=>(const Due&, const Due&) = default;
    };
    cosim::Time now() const;
    const Action& action_of(const Due& due) const;
    void schedule(std::size_t event, cosim::Time time, std::uint64_t serial);
    void repeat(const Due& due);
    void follow(std::size_t event, cosim::Time time, cosim::Time earliest);
    void hear();
    void finish(const Due& due, cosim::Time time, const std::string& refused, std::vector<std::string>& log);
    void carry_out(std::vector<std::string>& log);
    std::string send(const Action& action, cosim::Time time);
    std::string send_datagram(const Action& action, cosim::Time time);
    std::string press_key(const Action& action, cosim::Time time);
    std::string list() const;

    EventPlan plan_;
    Scene scene_;
    Watches watches_;
    Journal journal_;
    WorldModel& model_;
    CommandSource* commands_;
    std::set<Due> bodies_, boards_;          // what is due, by what it acts on
    std::map<std::uint64_t, Command> live_;  // by serial
    std::vector<std::uint64_t> begun_;       // how often each event of the plan was scheduled
    std::uint64_t serial_ = 0;
    std::multimap<cosim::Time, BoardSignal> signals_;
    std::vector<Datagram> datagrams_;  ///< in order of time
    bool toggle_ = false;              // of the remote control
    cosim::Time key_released_ = 0;     // of the last key
};

}  // namespace puckloop::physics
