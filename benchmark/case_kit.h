#pragma once
// Ways to measure that the cases of `puckloop bench` are made of. In every round the reference loop, this
// build and the peer run right after each other, so that a machine whose speed drifts changes no ratio.

#include "benchmark/cases.h"
#include "benchmark/measures/timed_run.h"

#include <functional>
#include <optional>

namespace puckloop::tools {

struct WorkProfile;

class Kit {
  public:
    explicit Kit(const BenchOptions& options);
    ~Kit();
    Kit(const Kit&) = delete;
    Kit& operator=(const Kit&) = delete;

    const BenchOptions& options() const { return options_; }
    /// For results; it goes with the measurement.
    const std::filesystem::path& folder() const { return folder_; }
    static std::filesystem::path shipped(const std::string& scenario);
    static std::filesystem::path main_image();
    std::filesystem::path rab_image() const;

    void time_core();
    /// The ATmega1284P beside libsimavr (benchmark/speeds/avr_speed.h).
    void time_avr();
    /// Range-and-bearing boards alone, one at a time.
    void time_boards();
    void time_runs(const std::string& name, const RunSpec& spec);
    /// Runs beside their boards alone (benchmark/speeds/board_replay.h).
    void time_overhead(const std::string& name, const std::filesystem::path& scenario, double simulated_s);
    /// Wandering robots: real-time factors, and what a robot costs among many.
    void time_growth(double simulated_s);
    /// The physical world alone, part by part (benchmark/speeds/world_cost.h).
    void time_world();
    /// Images on the main board that wait.
    void time_waiting();
    /// Twenty robots of a laboratory, and what their cost is made of (benchmark/speeds/work_profile.h).
    void time_lab20();
    /// Wandering robots: peak memory.
    void weigh(double simulated_s);

    std::vector<Figure> take_figures() { return std::move(figures_); }

  private:
    /// A speed that this process measures itself; the peer's `bench` measures the same under the same name.
    struct Speed {
        std::string name, unit;
        std::function<double()> once;
    };
    void time_speeds(const std::string& bench_case, const std::vector<Speed>& speeds);
    RunTiming own_run(const RunSpec& spec, const std::function<void(pid_t)>& watch = {}) const;
    /// Nothing without a peer, and when it cannot run this, which becomes `figure`'s note; it is not tried
    /// again.
    std::optional<RunTiming> peer_run(const RunSpec& spec, const RunTiming& own, Figure& figure) const;
    void add_reference(Figure& figure) const;
    void add_profile(const std::string& title, const WorkProfile& profile);

    BenchOptions options_;
    std::filesystem::path folder_;
    std::vector<Figure> figures_;
};

}  // namespace puckloop::tools
