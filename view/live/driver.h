#pragma once
// Drives a run that was started with --control: lets it go on at a speed, stops it, goes on by steps, has
// things done to its world. One client of the control protocol (docs/control_protocol.md), for all pages of a
// viewer.

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

    /// control.json there names a run that goes on and takes a client.
    static bool is_there(const std::filesystem::path& folder);

    /// A request of a page, JSON: "page" (its name), "do": "play" with "speed" (times real time; 0: as fast
    /// as it goes), "pause", "step" with "ms" (1..10,000), "act" with "command", "end", "take". The first
    /// page that asks for anything drives, others are refused until they "take" it. Returns "" or why it is
    /// refused.
    std::string request(const std::string& text);

    /// JSON: time_s, playing, speed, over, why, driver, acts (the latest: number, command, answer, refused).
    std::string state() const;
    /// The run goes on.
    bool on() const;

    static constexpr std::size_t kMostWaiting = 100;  ///< steps and acts that are not done yet
    static constexpr std::size_t kKeptActs = 50;

  private:
    struct Act {
        std::uint64_t number = 0;
        std::string command, answer;
        bool refused = false;
    };
    struct Work {
        int ms = 0;           // a step, if not 0
        std::string command;  // an act, if not empty
    };
    void run() noexcept;
    bool serve();
    std::string ask(const std::string& request);
    void step(int ms);
    void act(const std::string& command);
    void end_run();

    int socket_ = -1;
    std::string received_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Work> waiting_;
    std::vector<Act> acts_;
    std::uint64_t act_number_ = 0;
    std::string driver_, why_;
    double time_s_ = 0.0, speed_ = 1.0;
    bool playing_ = false, end_ = false, over_ = false;
    std::thread thread_;
};

}  // namespace puckloop::view
