#pragma once
// The log of a TAM's board: resets, registers without a model, what its console prints, the colours it shows,
// what its barriers see, when it switches itself off. It counts without a log as well.

#include "emu/board/timed_lines.h"
#include "emu/image/avr_image.h"
#include "emu/tam_avr/board.h"

#include <array>
#include <string>

namespace puckloop::tam {

class TamLog {
  public:
    /// An empty path is no log. `start`: when the board is switched on. Throws RunError as NodeLog does.
    TamLog(const std::string& path, const image::AvrImage& image, cosim::Time start);

    cosim::Time next_look() const { return lines_.next_look(); }
    void look(const avr::Chip& chip);
    void end(cosim::Time now, const Board& board);

    void signal_changed(SignalId id, double value, cosim::Time now);
    void input(SignalId id, double value, cosim::Time now);
    /// Both at the stop bit.
    void sent(int unit, const cosim::UartFrame& frame, cosim::Time now);
    void arrived(int unit, const cosim::UartFrame& frame, cosim::Time now, bool listening);

    /// Times that each beam was interrupted, by more than half of it.
    const std::array<std::uint64_t, kBarriers>& interruptions() const { return interruptions_; }
    /// Changes of the transceiver's emitter.
    std::uint64_t emitter_edges() const { return emitter_edges_; }
    /// When the supply went; kNever while it is there.
    cosim::Time switched_off() const { return switched_off_; }

    template <class Archive>
    void state(Archive& archive) {
        archive(lines_, resets_, unmodelled_, warnings_, uarts_, line_, line_count_, blocked_, interruptions_,
                emitter_edges_, network_led_changes_, colour_changes_);
        archive.bounded(switched_off_, 0, cosim::kNever);
        for (double& duty : shown_)
            archive.bounded(duty, 0.0, 1.0);
        for (double& duty : duty_)
            archive.bounded(duty, 0.0, 1.0);
    }
    /// As TimedLines.
    void loaded(cosim::Time now) { lines_.loaded(now); }
    void mark() { lines_.mark(); }
    void rewind() { lines_.rewind(); }
    void settle() { lines_.settle(); }

  private:
    struct UartSeen {
        bool sent = false, arrived = false;
        template <class Archive>
        void state(Archive& archive) {
            archive(sent, arrived);
        }
    };
    void read_report(cosim::Time now, const avr::Chip& chip);
    void read_colours(cosim::Time now);
    void text(char character, cosim::Time now);

    board::TimedLines lines_;
    cosim::Time start_;
    std::size_t resets_ = 0, unmodelled_ = 0, warnings_ = 0;
    std::array<UartSeen, 2> uarts_;
    std::string line_;  // of the console, not yet ended
    std::uint64_t line_count_ = 0;
    std::array<bool, kBarriers> blocked_{};
    std::array<std::uint64_t, kBarriers> interruptions_{};
    std::uint64_t emitter_edges_ = 0, network_led_changes_ = 0, colour_changes_ = 0;
    std::array<double, kLeds> duty_{}, shown_{};  // now, and as last logged
    cosim::Time switched_off_ = cosim::kNever;
};

}  // namespace puckloop::tam
