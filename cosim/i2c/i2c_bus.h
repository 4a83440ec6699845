#pragma once
// The two wires of one robot's I2C bus, its masters and its devices. Source: I2C-bus specification UM10204;
// phases as in cosim/core/message.h.
//
// A master sends Start (with the address byte), Write, Read and Stop, each stamped with `start` = the first
// clock of its byte, and waits for the answer to all but Stop: Acknowledge or Data, stamped when the ninth
// clock ends, stretch included; nobody at the address: ack = 0. BusLost: somebody else has the bus.
//
// Like a UART link the bus has a nominal clock: no answer comes earlier than nine nominal clocks after the
// phase began, so a master faster than nominal is answered late by the difference. This is the bus's
// lookahead.
//
// A Start while another master owns the bus waits for its end where the master's driver does so (`waits`,
// Linux), and is lost where the master only sees a collision (the dsPIC). Starts within half a nominal clock
// of each other collide: the lower address byte wins, as its first 0 against a 1 does on the wires.
//
// Masters with the same address byte go on together (i2c_shared.h): SCL stays low until each has stated what
// it does next, and the first bit in which they differ decides, in data bytes and in the ninth clock of a
// byte read. The loser's BusLost is stamped with the end of that bit's clock; while masters share the bus its
// lookahead is one nominal clock. In the first clock of a byte a 0 is stronger than a STOP (SDA does not
// rise), a STOP than a repeated START (SDA is low), a repeated START than a 1 (SDA falls while SCL is high).
//
// Devices that are nodes of their own have a port each. As on the wires, each of them sees every Start (or
// those for `addresses`, if it has any) and decides itself whether it is meant; a device must answer: one
// that is switched off answers ack = 0. Those that acknowledged get what follows: Write, Read and Stop. All
// this is sent half a nominal clock after it began (`start` states when); by then masters have been
// distinguished. Each Start and Write is answered with Acknowledge and each Read with Data, in the device's
// own time: at `start` + 8 clocks when it does not stretch, later when it does. The bus hands the answer on
// one clock later. While such a device is asked the bus's lookahead is one nominal clock. A `prompt` one,
// which never stretches, is informed of each phase late, half a nominal clock before it must answer. The
// `ack` of a Read is what the master has decided when it begins; a dsPIC decides later and sends 1. So a
// device knows that its byte was the last one wanted when a Stop or Start follows it, not before.
//
// A chip that is master and device has a port for each (`I2cDevicePort::master`). It may lose the bus with
// its Start to a master that then addresses it.
//
// Several devices at one address answer together: SDA is low when any pulls it low, so their acknowledges are
// or-ed and their bytes and-ed, and the slowest sets the pace.
//
// A master may break what its address byte agreed. Who reads from devices that are to receive sends them
// ones; who writes to devices that are to send finds SDA the and of both, is acknowledged by nobody, and has
// lost the bus at its first 1 against a 0: the devices are then in the middle of a byte and hold SDA low. The
// ninth clock of a byte read may come after it, as an Acknowledge with ack = 0 from the master: the devices
// send no more until the next START. Before a STOP or a repeated START where devices are to send a byte a
// master asks for their first bit (kNoByteFollows in i2c_shared.h), which may be in the way. Clocks that are
// out of step with the bytes of devices that receive come as LooseClocks (i2c_bus_loose.cpp).
//
// A master that loses patience sends its Stop while a device still holds SCL low: nobody can use the bus
// until the device lets go. If it then holds SDA low, being in the middle of a byte, the bus is free once a
// Linux driver has given it nine clocks and a STOP (i2c_generic_scl_recovery()); a dsPIC only sees a
// collision.
//
// Deviations: 1. an arbitration lost in the address byte of a START is reported when the ninth clock ends,
// not at the bit. 2. A repeated START of masters that share the bus begins with its address byte: it collides
// then. Of two masters of which one reads while the other writes the writer goes on. 3. SCL of colliding
// masters is the winner's, of those that go on together the slowest's. 4. Pins driven low by a master's ports
// do not disturb the bus.

#include "base/states/checkpoint.h"
#include "cosim/core/node.h"
#include "cosim/i2c/i2c_faults.h"
#include "cosim/i2c/i2c_log.h"
#include "cosim/i2c/i2c_slave.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::cosim {

struct I2cMasterPort {
    std::string name;    ///< port name: "pic", "linux"
    bool waits = false;  ///< a Start waits for the end of another master's transfer
};

/// A device in another node.
struct I2cDevicePort {
    std::string name;  ///< port name: "rab"
    std::vector<std::uint8_t>
        addresses{};      ///< 7 bits; it is informed of Starts for these only, empty: of all
    bool prompt = false;  ///< never stretches: knows its answer at once
    /// The master port of the same chip. Its own transfers do not reach the device; of those of others it
    /// notices every START and every STOP, as the chip's status bits do.
    std::optional<PortIndex> master{};
};

struct I2cBusOptions {
    std::string name = "i2c";
    double nominal_hertz = 100e3;
    std::vector<I2cMasterPort> masters;
    std::vector<I2cDevicePort> devices{};
    std::string log{};  ///< file for the bus's log; empty: none
    std::vector<CarriedFault> faults{};
};

/// Ports: the masters in their order, the devices in theirs, then "world" (signals to and from the devices in
/// this node).
class I2cBusNode final : public Node {
  public:
    I2cBusNode(I2cBusOptions options, std::vector<std::unique_ptr<I2cSlave>> slaves);

    std::string_view name() const override { return options_.name; }
    std::span<const Port> ports() const override { return ports_; }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override;
    Time earliest_output(PortIndex port) const override;
    Time lookahead(PortIndex port) const override;
    Rewindable* rewindable() override { return going_back_ ? &*going_back_ : nullptr; }
    std::string finish() override;

  private:
    /// Bus, log and devices together.
    class GoingBack : public Rewindable {
      public:
        explicit GoingBack(I2cBusNode& bus) : bus_(bus) {}
        void mark() override;
        void rewind() override;
        void settle() override;

      private:
        I2cBusNode& bus_;
        Checkpoint checkpoint_;
    };
    friend class puckloop::CheckpointWriter;
    friend class puckloop::CheckpointReader;
    template <class Archive>
    void state(Archive& archive) {
        archive(bus_, owner_, addressed_, addressed_devices_, read_, finished_, pending_, holders_, crowds_);
        archive(stuck_since_, stuck_for_, stuck_names_, changes_, contenders_, waiting_, answers_);
        archive(emitted_at_, counters_, log_, now_, faults_, line_released_, incomplete_byte_);
        archive(sharers_, turns_, reads_, ninth_, given_, refusing_, line_low_, announce_, byte_read_);
        archive(loose_bits_, held_);
    }

    struct Contender {
        PortIndex port = 0;
        I2cPhase phase;
    };
    struct Counters {
        std::uint64_t transfers = 0, not_acknowledged = 0, lost = 0, bytes_written = 0, bytes_read = 0;
        std::uint64_t stretched = 0, stuck = 0;
        Time longest_stretch = 0;
        /// Starts that nobody acknowledged, by master and address.
        std::map<std::pair<PortIndex, std::uint8_t>, std::uint64_t> absent;

        template <class Archive>
        void state(Archive& archive) {
            archive(transfers, not_acknowledged, lost, bytes_written, bytes_read, stretched, stuck);
            archive(longest_stretch, absent);
        }
    };
    /// Devices that acknowledged one Start together.
    struct Crowd {
        std::uint64_t times = 0;
        std::string names;

        template <class Archive>
        void state(Archive& archive) {
            archive(times, names);
        }
    };

    /// What a master waits for while devices in other nodes think.
    struct Pending {
        PortIndex master = 0;
        I2cPhase phase;
        Time earliest = 0;
        std::vector<PortIndex> open;  ///< devices that have not answered yet
        I2cAnswer answer;             ///< of the others, together
        std::string who;              ///< acknowledged a Start
        int count = 0;
        bool addresses = false;    ///< devices take the byte for an address
        std::uint8_t flipped = 0;  ///< bits of the byte read that arrive inverted
        bool lost = false;         ///< to the master the bus is lost
        Time busy_until = 0;       ///< and somebody else's until then
        int clocked = 0;           ///< of LooseClocks: those that are over ...
        std::uint8_t line = 0xFF;  ///< ... SDA in the first eight ...
        bool ninth_low = false;    ///< ... and in the ninth

        template <class Archive>
        void state(Archive& archive) {
            archive(master, phase, earliest, open, answer, who, count);
            archive(addresses, flipped, lost, busy_until);
            archive.bounded(clocked, 0, 9);
            archive(line, ninth_low);
        }
    };

    /// In place of a port: a line that a fault holds low, and the master of a transfer that a fault begins.
    static constexpr PortIndex kFault = 0xFFFF;

    bool is_master(PortIndex port) const { return port < options_.masters.size(); }
    bool is_world(PortIndex port) const { return port + 1u == ports_.size(); }
    void run_events(Time until);
    void receive(const Message& message);
    void phase_from(PortIndex port, const I2cPhase& phase);
    void start_from(PortIndex port, const I2cPhase& phase);
    void open_contest(PortIndex port, const I2cPhase& phase);
    void resolve_contest();
    void address(PortIndex port, const I2cPhase& phase, Time earliest);
    void device_answered(PortIndex port, const I2cPhase& phase, Time now);
    void byte_from(PortIndex port, const I2cPhase& phase);
    void ask_device(I2cSlave& slave, const I2cPhase& seen);
    void not_acknowledged(const I2cPhase& phase);
    I2cPhase begin_phase(PortIndex port, const I2cPhase& phase, Time earliest, bool& heard);
    void offer_address(const I2cPhase& seen);
    void hold_line(const I2cPhase& phase, Time time);
    void line_released();
    void reset_devices(Time now);
    bool begin_incomplete();
    void go_on_incomplete(bool acknowledged);
    Time next_event() const;
    void take_answer(const I2cAnswer& reply, const std::string& name);
    void settle();
    /// How the transfer of the devices that are addressed ends.
    enum class Ending { Stop, RepeatedStart, Reset };
    /// `address_byte`: of a repeated START.
    void release_devices(Time now, Ending ending, std::uint8_t address_byte = 0);
    bool informed_of(PortIndex device, std::uint8_t address_byte) const;
    bool own_master(PortIndex device, PortIndex master) const;
    bool own_transfer(PortIndex device) const;
    void hang();
    void let_go(const I2cPhase& phase);
    void sda_held();
    void acknowledge_was_in_the_way(PortIndex port, const I2cPhase& phase);
    void ask_first_bit(PortIndex port, const I2cPhase& phase);
    void settle_first_bit();
    void begin_loose(PortIndex port, const I2cPhase& phase);
    void go_on_loose();
    bool ask_loose();
    void in_the_way();
    bool is_prompt(PortIndex device) const {
        return options_.devices[device - options_.masters.size()].prompt;
    }
    void recover(Time from);
    const std::string& device_name(PortIndex port) const;
    std::string device_list() const;
    std::vector<std::string> warnings() const;
    void stop_from(PortIndex port, const I2cPhase& phase);
    bool shares(PortIndex port) const;
    void turn_from(PortIndex port, const I2cPhase& phase);
    void take_turns();
    void answer_sharer(PortIndex port, const I2cPhase& phase, I2cPhaseKind kind, bool low, int clocks);
    void lose_share(PortIndex port, const I2cPhase& phase, int clocks);
    void drop_sharer(PortIndex port);
    void give_up(PortIndex port, const I2cPhase& phase);
    void forget_sharers();
    void answer_readers(const Pending& done);
    void decide_ninth_clock();
    void answer_masters(const Pending& done, I2cPhaseKind kind, const I2cAnswer& reply);
    void bus_freed();
    void lose(PortIndex port, const I2cPhase& phase, const I2cAnswer& reply = {}, Time earliest = 0);
    void answer(PortIndex port, const I2cPhase& phase, I2cPhaseKind kind, const I2cAnswer& answer,
                Time earliest);
    Time ninth_clock(const I2cPhase& phase) const;
    Time half_clock() const { return nominal_period_ / 2; }
    /// How long after its begin a device in another node is informed of a phase.
    Time told_after(PortIndex device) const;
    bool awaits_devices() const;

    I2cBusOptions options_;
    std::vector<Port> ports_;
    std::vector<std::unique_ptr<I2cSlave>> slaves_;
    Time nominal_period_;
    I2cSlave::Emit emit_;

    enum class Bus : std::uint8_t {
        Free,
        Contest,
        Owned,
        Stopping,
        Stuck,       ///< a device holds SCL low and nobody waits for it
        HeldLow,     ///< a device holds SDA low
        Recovering,  ///< nine clocks and a STOP are being given
    } bus_ = Bus::Free;
    PortIndex owner_ = 0;
    std::vector<I2cSlave*> addressed_;          // devices here
    std::vector<PortIndex> addressed_devices_;  // devices in other nodes
    bool read_ = false;                         // the last address byte asked them to send
    bool finished_ = false;  // a byte that they sent was not acknowledged: they wait for a START
    std::optional<Pending> pending_;
    std::vector<PortIndex> holders_;  // of SCL, while the bus is stuck
    std::map<std::uint8_t, Crowd> crowds_;
    Time stuck_since_ = 0, stuck_for_ = 0;
    std::string stuck_names_;
    I2cFaults faults_;
    Time line_released_ = kNever;        // by a fault that holds SCL low behind a byte
    bool incomplete_byte_ = false;       // of a fault's transfer: a byte is still to follow the address
    Time changes_ = kNever;              // a contest is decided, a stop or recovery is over
    std::vector<Contender> contenders_;  // for the bus, now
    std::vector<Contender> waiting_;     // for its end
    /// Masters that sent the same so far, the owner among them, until the STOP; empty: it is alone.
    std::vector<PortIndex> sharers_;
    std::vector<Contender> turns_;     // what sharers do next
    std::vector<Contender> reads_;     // what they did last, each with its own acknowledge
    std::vector<PortIndex> ninth_;     // sharers whose acknowledge of a byte read is to come
    std::vector<Contender> given_;     // those that have come
    std::vector<Contender> refusing_;  // sharers that refuse the byte, until it is known who acknowledges
    bool line_low_ = false;            // somebody acknowledges it
    bool announce_ = false;            // the sharers are to be informed with their answer
    std::uint8_t byte_read_ = 0;
    std::uint8_t loose_bits_ = 0;   // of the devices' byte, by clocks out of step
    bool held_ = false;             // devices acknowledge it in the clock that comes
    std::vector<Message> answers_;  // known, to leave with this advance
    Time emitted_at_ = 0;
    Counters counters_;
    I2cLog log_;
    Time now_ = 0;  // of the event that is being handled
    std::optional<GoingBack> going_back_;
};

}  // namespace puckloop::cosim
