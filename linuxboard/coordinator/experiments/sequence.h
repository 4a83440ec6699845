#pragma once
// Tasks that have to be done in order, one at each TAM of a list. Only the TAM whose turn it is shows its
// colour; a robot that enters it works for its time and is answered 0x7F by infra-red (0x10 while it works),
// and the next TAM opens. A robot that enters a TAM out of turn has made a mistake: it is answered 0x70, and
// the round begins again if `on-mistake` asks for it. Behind the last task the round is complete.

#include "linuxboard/coordinator/controller.h"
#include "linuxboard/coordinator/parameters.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::coordinator {

std::span<const Parameter> sequence_parameters();

struct SequenceSettings {
    struct Stage {
        std::string tam;  ///< its name; no TAM twice
        Color color;
        double duration = 0;  ///< s
    };
    std::vector<Stage> stages;
    Color busy;
    double dead_time = 0;      ///< s between two rounds
    double time_limit = 0;     ///< s for a stage to begin once it is open, behind the first; 0: none
    bool restart = true;       ///< by a mistake
    std::uint64_t rounds = 0;  ///< the experiment ends behind so many; 0: never
};

/// Throws InputError.
SequenceSettings read_sequence(const Parameters& parameters);

class SequenceController;

class Sequence : public Experiment {
  public:
    static constexpr std::uint8_t kWait = 0x10, kRight = 0x7F, kWrong = 0x70;  ///< answers to robots

    explicit Sequence(SequenceSettings settings) : settings_(std::move(settings)) {}
    std::unique_ptr<Controller> attach(Tam& tam) override;
    void step(double now) override;
    bool finished() const override { return settings_.rounds != 0 && rounds_ == settings_.rounds; }

    // --- for its controllers -------------------------------------------------
    const SequenceSettings& settings() const { return settings_; }
    /// The stage whose turn it is, from 0; nothing between two rounds.
    bool open(std::size_t stage) const { return !pause_ && stage == stage_; }
    void work_begins() { idle_since_ = -1; }
    void work_aborted(double now) { idle_since_ = now; }
    void stage_done(double now);
    void mistake(double now);
    std::uint64_t rounds() const { return rounds_; }
    /// Rises whenever a round is begun anew.
    std::uint64_t attempt() const { return attempt_; }

  private:
    void begin_round(double now);

    SequenceSettings settings_;
    std::size_t stage_ = 0;
    std::uint64_t rounds_ = 0, attempt_ = 0;
    bool pause_ = false;
    double pause_until_ = 0;
    double idle_since_ = -1;  ///< the open stage has no robot; below 0: it has
};

}  // namespace puckloop::coordinator
