#pragma once
// The e-puck main board as a node of a run: chip, board, and the ports where links attach.

#include "cosim/core/stateful_node.h"
#include "emu/board/node_state.h"
#include "emu/board/nvm_file.h"
#include "emu/chip/faults/board_faults.h"
#include "emu/dspic/chip/chip_faults.h"
#include "emu/image/image.h"
#include "emu/pic/board.h"
#include "emu/pic/empty_bus.h"
#include "emu/pic/pic_log.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::pic {

struct PicNodeOptions {
    BoardParameters board;  ///< its name is the node's name
    /// The board has the port "ir", as IRcom's medium (physics/ircom) needs it.
    bool ircom = false;
    /// UART1's TX pulled low by the port pin is a break on the line, as for a Bluetooth module. Where the
    /// firmware lets go before a character is over, that is not seen.
    bool uart1_breaks = false;
    bool i2c_linked = true;  ///< false: nobody else is on the bus, and the node answers the master itself
    /// It is a device of the linked bus too, by the port "i2c_slave".
    bool i2c_slave = false;
    /// No master on the bus is faster; one that is gets the board's answers as if it were not.
    double fastest_i2c_hertz = 400e3;
    bool skip_idle = true;            ///< busy-wait loops are skipped forward
    std::vector<cosim::Time> resets;  ///< the reset button (a pulse on MCLR), rising times above 0
    /// Configuration word in force on the robot, as its bootloader left it: XT with PLL x8.
    std::uint16_t fosc = kFoscXtPll8;
    static constexpr std::uint16_t kFoscXtPll8 = 0xC706;
    std::string log{};                           ///< file for the board's log; empty: none
    std::shared_ptr<board::NvmFile> nvm{};       ///< keeps flash and EEPROM at the end; null: nothing does
    std::optional<camera::Fitting> camera{};     ///< on the board; it has the port "camera" then
    std::shared_ptr<camera::Scenery> scenery{};  ///< what the camera looks at; the port's signals change it
    std::string camera_log{};                    ///< file for a line per picture; empty: none
    std::vector<cosim::CarriedFault> faults{};   ///< of this board
};

class PicNode : public cosim::StatefulNode,
                public cosim::CountsWork,
                private BoardListener,
                private chip::BoardAccess {
  public:
    static constexpr cosim::PortIndex kUart1 = 0;
    static constexpr cosim::PortIndex kUart2 = 1;
    static constexpr cosim::PortIndex kI2c = 2;
    static constexpr cosim::PortIndex kWorld = 3;
    static constexpr cosim::PortIndex kIr = 4;  ///< if `ircom`: pulses out, ir_light in

    /// The port "i2c_slave", of a board that is one.
    cosim::PortIndex slave_port() const { return slave_port_; }
    /// The port "camera", behind all others.
    cosim::PortIndex camera_port() const { return static_cast<cosim::PortIndex>(ports_.size() - 1); }
    /// The port "camera_i2c" before it, of a camera that is a device of a linked bus.
    cosim::PortIndex camera_bus_port() const { return static_cast<cosim::PortIndex>(ports_.size() - 2); }

    /// Throws InputError if the image does not fit the chip, or a fault neither.
    PicNode(const image::Image& image, const PicNodeOptions& options);

    std::string_view name() const override { return options_.board.name; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    std::optional<cosim::Time> begun(cosim::PortIndex port) const override;
    /// JSON: cycles, instructions, resets, traps, unmodelled registers, motor and UART counters.
    std::string finish() override;
    void add_work(cosim::WorkCounts& counts) const override;

    void state(StateWriter& archive) const override;
    void state(StateReader& archive) override;
    void state(CheckpointWriter& archive) const;
    void state(CheckpointReader& archive);
    cosim::Rewindable* rewindable() override { return &mark_; }
    void renew_random_streams() override { board_.renew_random_streams(); }

    dspic::Chip& chip() { return *chip_; }
    /// The end of the last advance.
    cosim::Time granted() const { return granted_; }
    /// A pulse on the reset pin where the chip is: between two advances, or before an instruction
    /// (chip::Instrument). What leaves at once goes to `outbox`.
    void press_reset(std::vector<cosim::Message>& outbox) {
        auto* const before = std::exchange(outbox_, &outbox);
        chip_->mclr();
        outbox_ = before;
    }
    Board& board() { return board_; }

  private:
    void run_until(cosim::Time until);
    void run_chip(cosim::Time until);
    void settle(cosim::Time until);
    /// Presses the reset button where it is due before (or at) `until`.
    void press_reset(cosim::Time until, bool inclusive);
    /// Lets the faults act that are due before (or at) `until`.
    void run_faults(cosim::Time until, bool inclusive);
    void receive(const cosim::Message& message);
    bool is_camera_bus(cosim::PortIndex port) const {
        return options_.camera && options_.i2c_linked && port == camera_bus_port();
    }
    bool is_slave(cosim::PortIndex port) const { return options_.i2c_slave && port == slave_port_; }
    cosim::Time fastest_i2c_period() const;
    cosim::Time slave_lookahead() const;
    cosim::Time earliest_answer() const;
    /// A phase for the chip as a device of the bus.
    void slave_phase(cosim::I2cPhase phase, cosim::Time now);
    cosim::Time camera_lookahead() const;
    /// A phase for the camera as a device of the bus.
    void camera_phase(const cosim::I2cPhase& phase, cosim::Time now);

    void signal_changed(SignalId id, double value, dspic::Cycle now) override;
    void uart_sent(int unit, const cosim::UartFrame& frame) override;
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override;
    void i2c_answer(const cosim::I2cPhase& answer, cosim::Time now) override;
    void can_to_bus(int unit, const cosim::CanMessage& message) override;
    void step_lost(int motor, dspic::Cycle now) override;
    void line_pulled_low(dspic::Cycle now) override;
    void edges_moved(dspic::Cycle at) override { chip_->edges_moved(at); }
    void set_sag(double volts) override;
    void set_battery(std::optional<double> volts) override;
    void set_ambient(const chip::AmbientShares& shares) override { board_.set_ambient(shares); }
    void set_motor(int motor, std::uint8_t open, bool stalled) override;
    dspic::Cycle message_cycle() const { return chip_->clock().first_cycle_at(chip_->now()); }

    PicNodeOptions options_;
    std::vector<cosim::Port> ports_;
    cosim::PortIndex slave_port_ = 0;
    board::CanPorts can_;
    Board board_;
    std::unique_ptr<dspic::Chip> chip_;
    EmptyBus bus_;
    PicLog log_;
    std::optional<dspic::ChipFaults> chip_faults_;
    std::unique_ptr<chip::BoardFaults>
        faults_;  ///< null: none was asked for, nor was there any in a loaded state
    /// What goes back beside chip and board.
    struct Followers {
        PicLog& log;
        camera::Scenery* scenery = nullptr;
        void mark() {
            log.mark();
            if (scenery) scenery->mark();
        }
        void rewind() {
            log.rewind();
            if (scenery) scenery->rewind();
        }
        void settle() {
            log.settle();
            if (scenery) scenery->settle();
        }
    };
    Followers followers_{log_};
    board::NodeMark<PicNode, dspic::Chip, Followers> mark_{*this, chip_, followers_};
    std::vector<cosim::Message>* outbox_ = nullptr;
    cosim::Time granted_ = 0;
    std::size_t next_reset_ = 0;
};

}  // namespace puckloop::pic
