#pragma once
// The coordinator's work: it finds the TAMs of its network, passes on what they report, sends what
// controllers request, and steps the experiment every 10 ms.
// Protocol and times: TAM fact sheet, sections 7 and 9.

#include "linuxboard/coordinator/controller.h"
#include "linuxboard/coordinator/event_log.h"
#include "linuxboard/coordinator/module.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace puckloop::coordinator {

/// The module does not answer as one must that a coordinator can use.
class ModuleError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

struct Settings {
    std::string port;             ///< for messages
    double duration = 0;          ///< s from the start of the experiment; 0: without end
    double end_wait = 10;         ///< s at most for the LEDs to go off at the end
    double discover_every = 600;  ///< s
    bool shut_down = false;       ///< TAMs are switched off at the end
};

class Coordinator {
  public:
    static constexpr double kStep = 0.01;  ///< s

    /// `ended` is asked at every step; true ends the run in order.
    Coordinator(control::Transport& line, Experiment& experiment, EventLog& log, Settings settings,
                std::function<bool()> ended);

    /// Start-up, experiment, LEDs off. Throws ModuleError and control::LineError.
    void run();

    /// Time since the coordinator was made, s.
    double now() { return module_.now() - begun_; }
    const Module::Counters& counters() const { return module_.counters(); }

  private:
    struct Booth {
        std::unique_ptr<Tam> tam;
        std::unique_ptr<Controller> controller;
        State state;
        bool shown = false;  ///< `state` is in the table
    };
    /// Frames that the module has not reported on, at most kWindow: its buffer is small.
    struct Flight {
        std::uint8_t id = 0;
        Tam* tam = nullptr;
        double since = 0;
    };

    // start_up.cpp
    bool start_up();
    std::optional<protocols::XBeeBytes> step(int number, std::string_view command, std::string_view asked,
                                             protocols::XBeeBytes value = {});

    void take(const protocols::XBeeMessage& message);
    void take_found(const protocols::XBeeAtResponse& response);
    void take_data(const protocols::XBeeRx& data);
    void add(const std::string& name, std::uint64_t address);
    Booth* at(std::uint64_t address);
    void ask_periodically();
    void work();
    void listen();
    void send_wishes();
    void step_controllers();
    void switch_off();
    void note(const std::string& event, const std::string& value, const std::string& detail = {});

    Experiment& experiment_;
    EventLog& log_;
    Settings settings_;
    std::function<bool()> ended_;
    Module module_;
    double begun_;
    double steps_ = 0;   ///< the next step is due so many kStep behind `begun_`
    double window_ = 0;  ///< s: the modules answer a discovery within this
    double next_discovery_ = 0, earliest_discovery_ = 0, next_strength_ = 0;
    std::vector<Booth> booths_;           ///< in the order of their discovery
    std::vector<std::uint64_t> unnamed_;  ///< reported before they were discovered
    std::vector<std::uint64_t> ignored_;  ///< noted already: no TAM, or a second one of its name
    std::deque<Flight> flights_;
    std::size_t turn_ = 0;  ///< the booth whose request is looked at first
    std::uint8_t last_id_ = 0;
};

}  // namespace puckloop::coordinator
