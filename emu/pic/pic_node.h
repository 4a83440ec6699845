#pragma once
// The e-puck main board as a node of a run: chip, board, and the ports where links attach.

#include "cosim/core/sampled_inputs.h"
#include "emu/board/dspic_node.h"
#include "emu/board/i2c_device.h"
#include "emu/board/nvm_file.h"
#include "emu/board/turn_hold.h"
#include "emu/image/image.h"
#include "emu/pic/board.h"
#include "emu/pic/empty_bus.h"
#include "emu/pic/pic_log.h"

#include <memory>
#include <optional>
#include <string>
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

class PicNode : private BoardListener,
                public board::DspicNode<PicNode, Board, PicLog>,
                public cosim::SampledInputs {
    friend board::BoardNode<PicNode>;
    friend board::DspicNode<PicNode, Board, PicLog>;

  public:
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

    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    /// JSON: cycles, instructions, resets, traps, unmodelled registers, motor and UART counters.
    std::string finish() override;
    cosim::Rewindable* rewindable() override { return &mark_; }

    bool sampled(cosim::PortIndex) const override { return false; }
    std::optional<cosim::PortIndex> turn_port() const override;
    bool has_turn() const override;
    cosim::Time advance_sampling(const cosim::SampledReach& reach, std::span<const cosim::Message> inbox,
                                 std::vector<cosim::Message>& outbox) override;

  private:
    static constexpr int kI2cUnit = 1;

    void run_board(cosim::Time until);
    bool held_back() const { return turn_.limit() <= chip_->now(); }
    void settle(cosim::Time until);
    void receive(const cosim::Message& message);
    void receive_signal(const cosim::Message& message, const cosim::Signal& signal);
    bool is_camera_bus(cosim::PortIndex port) const {
        return options_.camera && options_.i2c_linked && port == camera_bus_port();
    }
    bool is_slave(cosim::PortIndex port) const { return options_.i2c_slave && port == slave_port_; }
    cosim::Time camera_lookahead() const;
    /// A phase for the camera as a device of the bus.
    void camera_phase(const cosim::I2cPhase& phase, cosim::Time now);

    void signal_changed(SignalId id, double value, dspic::Cycle now) override;
    void uart_sent(int unit, const cosim::UartFrame& frame) override { send_uart(unit, frame); }
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override;
    void i2c_answer(const cosim::I2cPhase& answer, cosim::Time now) override;
    void can_to_bus(int unit, const cosim::CanMessage& message) override { send_can(unit, message); }
    void step_lost(int motor, dspic::Cycle now) override;
    void line_pulled_low(dspic::Cycle now) override;
    void edges_moved(dspic::Cycle at) override { chip_->edges_moved(at); }
    void set_sag(double volts) override;
    void set_battery(std::optional<double> volts) override;
    void set_ambient(const chip::AmbientShares& shares) override { board_.set_ambient(shares); }
    void set_motor(int motor, std::uint8_t open, bool stalled) override;
    dspic::Cycle message_cycle() const { return chip_->clock().first_cycle_at(chip_->now()); }
    EmptyBus& own() { return bus_; }
    const EmptyBus& own() const { return bus_; }

    PicNodeOptions options_;
    cosim::PortIndex slave_port_ = 0;
    board::I2cDeviceTimes i2c_times_;
    EmptyBus bus_;
    board::TurnHold turn_;  ///< as the bus's master
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
};

}  // namespace puckloop::pic
