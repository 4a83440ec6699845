#pragma once
// Drives a run that was started with --control: lets it go on at a speed, stops it, goes on by steps, has
// things done to its world. One client of the control protocol (docs/control_protocol.md), for all pages of a
// viewer.

#include "view/live/control_client.h"

#include <nlohmann/json_fwd.hpp>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace puckloop::view {

class Driver {
  public:
    /// Connects to the run that control.json in `folder` names. Throws InputError: none that takes a client,
    /// or one that has another.
    explicit Driver(const std::filesystem::path& folder);
    /// Ends the run if it goes on.
    ~Driver();
    Driver(const Driver&) = delete;
    Driver& operator=(const Driver&) = delete;

    /// A request of a page, JSON: "page" (its name), "do": "play" with "speed" (times real time; 0: as fast
    /// as it goes), "pause", "step" with "ms" (1..10,000), "instruction" of "board", "act" with "command",
    /// "until" with "condition" (as typed), "board" (that it means if it names none) and "ms" (at most so
    /// long), "back" with "to_s", "fault" with "fault" (as --fault), "type" with "link", "from" and "text"
    /// (what is typed into the line as if that end had sent it), "flash" with "board" and "file" (a path on
    /// this machine), "interrupts" with "board" and "count" (they are counted or not), "look" with "board"
    /// and "items" (what to read, as typed, at most kMostItems), "end", "take". The first page that asks for
    /// anything drives, others are refused until they "take" it. Returns "" or why it is refused.
    std::string request(const std::string& text);

    /// JSON: time_s, playing, speed, over, why, driver, epoch (rises when what was recorded changes: the run
    /// went back), acts (the latest: number, command, answer, refused), until (the condition it goes on to
    /// now; empty: none), look (what was asked for at the time: "where" and "values").
    std::string state() const;
    /// JSON: boards, what faults the run can have (run/driven/possible_faults.h), and what can be done to its
    /// world (possible_actions.h).
    const std::string& possible() const { return possible_; }
    /// The run goes on.
    bool on() const;
    /// It does not go on just now.
    bool stands() const;
    /// As in state().
    std::uint64_t epoch() const;

    static constexpr std::size_t kMostWaiting = 100;  ///< steps and acts that are not done yet
    static constexpr std::size_t kKeptActs = 50;
    static constexpr std::size_t kMostItems = 40;  ///< that a page looks at

  private:
    struct Act {
        std::uint64_t number = 0;
        std::string command, answer;
        bool refused = false;
    };
    struct Work {
        enum class Kind { Step, Instruction, Act, Until, Back, Fault, Type, Flash, Ask, Look };
        Kind kind = Kind::Step;
        int ms = 0;           // of a step
        double to_s = 0.0;    // of going back
        std::string text{};   // command, fault, condition or file
        std::string board{};  // of a condition; to be flashed
    };
    void run() noexcept;
    bool serve();
    void carry_out(const Work& work);
    void step(const nlohmann::json& request);
    void act(const std::string& command);
    void until(const Work& work);
    void restart(const std::string& request, const std::string& command);
    void type(const std::string& request);
    void look();
    void note(const std::string& command, const std::string& answer, bool refused);
    void end_run();

    ControlClient run_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Work> waiting_;
    std::vector<Act> acts_;
    std::uint64_t act_number_ = 0;
    std::string driver_, why_;
    std::string possible_, board_, items_ = "[]", look_ = "null";  // JSON but for the board's name
    std::uint64_t epoch_ = 0;
    double time_s_ = 0.0, speed_ = 1.0;
    std::string until_;  ///< the condition that the run goes on to now; empty: none
    bool playing_ = false, end_ = false, over_ = false;
    bool stop_ = false;  ///< not on to until_ any more
    bool busy_ = false;  ///< the run has been asked for something
    std::thread thread_;
};

}  // namespace puckloop::view
