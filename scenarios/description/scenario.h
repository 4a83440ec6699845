#pragma once
// A scenario as plain data: the world, the robots with their firmware and Linux programs, the TAMs, the
// faults. docs/scenario.md explains its keys.

#include "cosim/faults/faults.h"
#include "emu/pic/pic_spec.h"
#include "emu/rab_board/rab_spec.h"
#include "emu/tam_avr/tam_spec.h"
#include "emu/wifi/wifi_settings.h"
#include "missions/mission.h"
#include "physics/events/event.h"
#include "physics/tracker/tracker_spec.h"
#include "scenarios/description/expectation.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::scenarios {

/// The Bluetooth module of a main board, on its UART1.
struct BluetoothModule {
    std::string name;        ///< that others see
    std::string pin;         ///< fixed PIN
    std::string address;     ///< "08:00:17:2C:00:01"
    bool automatic = true;   ///< transparent once somebody has linked with it
    double boot = 0.5;       ///< s from reset to READY
    std::string computer{};  ///< at the other end: "pty", "tcp:PORT", "script:FILE"; empty: no computer
    double connect = 0.0;    ///< s: when the computer begins to link
};

/// The air between Bluetooth devices (emu/bluetooth/times.h).
struct BluetoothMedium {
    double range = 10.0;       ///< m
    double discovery = 2.611;  ///< s, mean time until a device answers an inquiry
    /// s: mean and standard deviation.
    std::vector<double> name_time{2.5, 1.2}, link_time{9.9, 4.3}, release_time{1.0, 0.3};
};

/// The e-puck main board of a robot.
struct PicBoard {
    std::filesystem::path firmware;
    double crystal_ppm = 0.0;                    ///< error of the 7.3728 MHz crystal, + is fast
    double adc_noise = pic::PicSpec::kAdcNoise;  ///< counts, standard deviation
    bool adc_noise_given = false;  ///< by the scenario: then it holds for the phototransistors in any case
    int selector = 0;              ///< position of the rotary selector, 0..15
    std::string uart1;             ///< plugged in: "pty", "tcp:PORT", "script:FILE"; empty: nothing
    std::string uart2{};           ///< likewise, where no Linux board is
    std::vector<double> resets;    ///< s: the reset button (MCLR) is pressed, rising
    std::filesystem::path nvm{};   ///< file that keeps flash and EEPROM; empty: none
    std::optional<double> boot{};  ///< s: how long the firmware needs until it listens; none: not said
    std::string camera{};          ///< on the board: "po3030k", "po6030k" or "po8030d"; empty: none
    bool camera_turned = false;    ///< it lies on its side, as on early boards
    std::string revision = "1.2";  ///< of the board: "1.2" or "1.3"
    std::vector<std::string> errata{};  ///< of the chip (emu/dspic/devices/errata.h)
    std::optional<BluetoothModule> bluetooth{};
    /// Other masters of its I2C bus can address it; none: if its firmware sets an address (I2CADD).
    std::optional<bool> i2c_slave{};
};

/// The range-and-bearing board of a robot (e-RandB), on its I2C bus.
struct RabBoard {
    std::filesystem::path firmware;
    double crystal_ppm = 0.0;                    ///< error of the 4 MHz crystal, + is fast
    double adc_noise = rab::RabSpec::kAdcNoise;  ///< counts, standard deviation
    std::filesystem::path nvm{};                 ///< as of the main board
};

/// What a Linux board is late with, s. All zero: nothing. Only `oversleep` may be below 0.
struct LinuxDelays {
    double tty_batch = 0.0;         ///< received bytes are handed on at whole multiples of this
    double i2c_hold = 0.0;          ///< each transfer waits so long for the bus
    double oversleep = 0.0;         ///< a sleep ends so much later than asked; below 0: earlier
    double oversleep_jitter = 0.0;  ///< standard deviation; by it no sleep ends early
    bool oversleep_stated = false;  ///< either of the two: nothing is drawn in their place
};

/// A signal that a program gets.
struct LinuxSignal {
    double at = 0.0;   ///< s
    std::string send;  ///< without SIG: "INT"
};

/// A camera of a Linux board.
struct LinuxCamera {
    std::string kind;    ///< "omni" or "front"
    std::string device;  ///< such as /dev/video1
};

/// The Linux board of a robot: one program under the shim.
struct LinuxBoard {
    /// Program and arguments; the program's path is resolved. Empty: it waits for one of the command line.
    std::vector<std::string> command;
    std::vector<std::string> arguments{};  ///< of a program that the command line gives
    std::string hostname;                  ///< what gethostname() gives
    double start = 0.0;                    ///< s: when the program is started
    std::vector<double> restarts;          ///< s: killed and started again
    std::vector<LinuxSignal> signals;
    std::string folder;               ///< to work in, below the results; empty: puckloop's own
    std::string end_signal = "TERM";  ///< when the run is to end
    double grace = 2.0;               ///< s from the end signal to SIGKILL
    LinuxDelays late{};
    std::optional<double>
        clock_ppm{};  ///< error of its clocks, + is fast; none: drawn (run/nodes/linux_clocks.h)
    std::vector<std::string> serial_devices{"/dev/ttyS0"};  ///< names of the line to the main board
    std::vector<std::string> i2c_devices{"/dev/i2c-3"};     ///< names of the robot's bus
    std::vector<LinuxCamera> cameras{};
    std::string address{};         ///< on the network; empty: by its number
    std::int64_t save_frames = 0;  ///< every so-many-th frame of each camera is kept as a picture; 0: none
    int place_line = 0;
};

struct RobotBoards {
    std::string name;
    PicBoard pic;
    std::optional<RabBoard> rab;
    std::optional<LinuxBoard> linux_board;
    bool ground_sensor = true;  ///< the I2C board at 0x60 is fitted
    bool rgb_turret = true;     ///< the I2C board at 0x61 is fitted
};

/// A radio module as it is plugged in.
struct XBeeModule {
    bool fitted = true;
    std::uint64_t address = 0;
    std::string node_id;                                ///< NI
    std::map<std::string, std::uint32_t> parameters{};  ///< AT parameters in its flash, by command
    double boot = 0.05;                                 ///< s from reset to modem status
};

/// The air between radio modules.
struct RadioMedium {
    double range = 30.0;        ///< m, at full power
    double exponent = 3.5;      ///< of the power's fall with distance
    double loss = 0.0;          ///< share of frames that other users of the band spoil
    double processing = 0.001;  ///< s, of a frame in a module
};

/// The coordinator's radio module and what is at its serial line.
struct CoordinatorPlace {
    XBeeModule module;
    double x = 0.0, y = 0.0;              ///< m
    std::string uart;                     ///< plugged in: "pty", "tcp:PORT", "script:FILE"; empty: nothing
    double baud = 9600.0;                 ///< of what is plugged in
    std::optional<LinuxBoard> program{};  ///< plugged in: a computer that runs it, with the port `tty`
    std::string tty = "/dev/ttyUSB0";
};

/// A TAM: board and booth.
struct TamBoard {
    std::string name;
    std::filesystem::path firmware;       ///< ELF or HEX; empty: the project's own, as the build made it
    std::filesystem::path boot_loader{};  ///< empty: none
    double resonator_ppm = 0.0;           ///< error of the 16 MHz resonator, + is fast
    double adc_noise = tam::TamSpec::kAdcNoise;  ///< counts, standard deviation
    int network = tam::TamSpec::kNetwork;        ///< DIP switches, 0..3
    double battery = tam::TamSpec::kBattery;     ///< V
    std::string console{};          ///< plugged in: "pty", "tcp:PORT", "script:FILE"; empty: nothing
    double console_baud = 57600.0;  ///< of what is plugged in
    double start = 0.0;             ///< s: switched on
    std::vector<double> resets{};   ///< s: the reset button is pressed, rising, after `start`
    XBeeModule xbee{};
};

/// The network between Linux boards and hosts.
struct NetworkMedium {
    std::string address = "10.0.0.0";                     ///< of the network
    int prefix = 24;                                      ///< bits of it
    double latency = 1e-4;                                ///< s
    double rate = 0.0;                                    ///< bit/s; 0: packets take no time
    std::int64_t queue = 1000;                            ///< packets that a computer's interface keeps
    std::optional<wifi::WifiSettings> wifi{};             ///< there: by radio, with rates of its own
    std::optional<std::array<double, 2>> access_point{};  ///< m; none: ad-hoc
};

/// A computer on the network that is on no robot.
struct ComputerHost {
    std::string name;
    LinuxBoard board;
    std::optional<std::array<double, 2>> position{};  ///< m, of its radio; none: it is wired
};

/// A CAN module of a board: "robot0.pic.can1".
struct CanController {
    std::string board;  ///< node: "robot0.pic", "robot0.rab"
    int unit = 1;       ///< 1 or 2

    std::string port() const { return "can" + std::to_string(unit); }
    std::string name() const { return board + "." + port(); }
};

/// Wires between CAN modules.
struct CanBus {
    std::string name;  ///< of its node
    std::vector<CanController> controllers;
};

/// A program that judges the run by what the tracker sees ([mission] with kind = "program").
struct MissionCommand {
    std::vector<std::string> command;  ///< program and arguments; the program's path is resolved
    std::string better = "more";       ///< or "less"
    double timeout = 10.0;             ///< s of wall time that an answer may take
    std::string file, place{};         ///< of its table
};

struct Scenario {
    std::filesystem::path file;
    std::string name;                ///< the file's stem
    std::optional<double> duration;  ///< s; without it the run ends with the Linux programs
    std::uint64_t seed = 1;
    double uart_baud = 115200.0;      ///< nominal rate of the UART links
    double i2c_clock = 100e3;         ///< Hz, of Linux as bus master
    bool ideal_linux_clocks = false;  ///< Linux boards of several robots run alike, and sleep as asked
    bool record_ir = false;           ///< light of range-and-bearing boards, chip by chip, in trace.csv
    bool record_ircom = false;        ///< IRcom's light, edge by edge, in trace.csv
    physics::World world;             ///< robots in the same order as `robots`
    physics::EventPlan events;        ///< what happens to the world while it runs
    std::vector<RobotBoards> robots;
    std::vector<TamBoard> tams{};  ///< in the order of the world's booths
    RadioMedium radio{};
    BluetoothMedium bluetooth{};
    std::optional<CoordinatorPlace> coordinator{};
    std::vector<CanBus> can_buses{};
    std::optional<NetworkMedium> network{};  ///< none: sockets are the host's
    std::vector<ComputerHost> hosts{};
    std::optional<missions::Mission> mission{};
    std::optional<MissionCommand> mission_program{};  ///< in place of `mission`
    std::optional<physics::TrackerSpec> tracker{};    ///< there whenever a mission program is
    std::vector<cosim::FaultSpec> faults;
    std::vector<Expectation> expectations{};
    std::vector<std::string> allow{};      ///< failures that do not fail the run (tables/allowed_failures.h)
    std::vector<std::string> not_taken{};  ///< of an ARGoS experiment: "line 7: ...", what is otherwise here
    std::vector<std::filesystem::path> files{};  ///< that it was read from, its own first
    std::vector<std::string> ignored{};  ///< an overlay's [measurement]: of the measuring chain, not of a run
};

/// Any robot has a Bluetooth module.
inline bool has_bluetooth(const Scenario& scenario) {
    for (const RobotBoards& robot : scenario.robots)
        if (robot.pic.bluetooth) return true;
    return false;
}

}  // namespace puckloop::scenarios
