#pragma once
// The TAM's board as a node of a run: ports where the console, the radio module, the world and the infra-red
// light attach. Signals on every port are numbered as in tam::signals().
//
//   console  UART0
//   xbee     UART1, the socket of the radio module
//   pins     to the module: xbee_reset, xbee_rts, xbee_wake, power
//   world    out: the coloured LEDs; in: barriers, ambient light, battery
//   ir       out: proximity_emit; in: proximity_sense

#include "emu/avr/chip/chip_faults.h"
#include "emu/board/board_node.h"
#include "emu/board/node_state.h"
#include "emu/image/avr_image.h"
#include "emu/tam_avr/board.h"
#include "emu/tam_avr/tam_log.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tam {

struct TamNodeOptions {
    BoardParameters board;                      ///< its name is the node's name
    int network = 3;                            ///< DIP switches, 0..3: the network is 01B2 + this
    double battery = 3.7;                       ///< volts
    cosim::Time start = 0;                      ///< switched on
    bool skip_idle = true;                      ///< busy-wait loops are skipped forward
    std::vector<cosim::Time> resets{};          ///< the reset button, rising times after `start`
    std::string log{};                          ///< file for the board's log; empty: none
    bool pins_linked = true;                    ///< false: there is no radio module to hear of the pins
    bool ir_linked = true;                      ///< false: nobody sees the transceiver
    std::vector<cosim::CarriedFault> faults{};  ///< of this board
};

class TamNode : private BoardListener, public board::BoardNode<TamNode> {
    friend board::BoardNode<TamNode>;

  public:
    static constexpr cosim::PortIndex kConsole = 0, kXBee = 1, kPins = 2, kWorld = 3, kIr = 4;

    /// The image was checked against the chip (load_avr_image). Throws RunError as TamLog does.
    TamNode(const image::AvrImage& image, const TamNodeOptions& options);

    /// Never, once the board is off; while its chip sleeps, what wakes it next.
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    std::optional<cosim::Time> begun(cosim::PortIndex port) const override;
    /// JSON: cycles, instructions, resets, unmodelled registers, fuses, warnings, UART counters, barriers.
    std::string finish() override;

    void state(StateWriter& archive) const override;
    void state(StateReader& archive) override;
    void state(CheckpointWriter& archive) const;
    void state(CheckpointReader& archive);
    cosim::Rewindable* rewindable() override { return &mark_; }
    void renew_random_streams() override { board_->renew_random_streams(); }

    Board& board() { return *board_; }
    /// A pulse on the reset pin where the chip is: between two advances, or before an instruction
    /// (chip::Instrument). What leaves at once goes to `outbox`.
    void press_reset(std::vector<cosim::Message>& outbox) {
        collect(outbox, [this](bool running) { board_->reset_now(running); });
    }

  private:
    // The board's time begins when it is switched on.
    cosim::Time to_board(cosim::Time time) const { return time > options_.start ? time - options_.start : 0; }
    cosim::Time from_board(cosim::Time time) const { return time + options_.start; }

    void look() { log_.look(board_->chip()); }
    void run_board(cosim::Time until);
    void settle(cosim::Time) {}
    void push_reset_button() { board_->reset_button(); }
    void receive(const cosim::Message& message);

    void signal_changed(SignalId id, double value, cosim::Time now) override;
    void uart_sent(int unit, const cosim::UartFrame& frame) override;
    bool powered() const override { return board_->powered(); }
    void set_sag(double volts) override { board_->set_sag(volts); }
    void set_battery(std::optional<double> volts) override { board_->set_battery(volts); }
    void set_ambient(const chip::AmbientShares& shares) override { board_->set_ambient(shares); }

    TamNodeOptions options_;
    std::vector<std::string> warnings_;  // of the image
    TamLog log_;
    std::unique_ptr<Board> board_;
    std::optional<avr::ChipFaults> chip_faults_;
    board::NodeMark<TamNode, Board, TamLog> mark_{*this, board_, log_};
};

}  // namespace puckloop::tam
