#pragma once
// A serial line with a simulated clock and a model of a PIC at its far end, for tests of the control program.
// The model knows the two characters of firmware: the original (waits for ever, reacts slowly in its waiting
// loop) and the project's own (drops partial records, boots at once). Faults are set byte by byte.

#include "linuxboard/control/devices/transport.h"
#include "protocols/serial/epuck_serial.h"

#include <cstdint>
#include <deque>
#include <map>
#include <vector>

namespace puckloop::control {

/// How a firmware behaves, in seconds.
struct FirmwareCharacter {
    double waiting_poll = 0.110;  ///< longest time a byte waits in the waiting loop
    double partial_timeout = 0;   ///< a partial record is dropped after so long without a byte; 0: never
    double boot = 19.8;           ///< reset to waiting loop; bytes are lost during the first part
    double deaf = 17.63;          ///< of the boot: UART off
};

inline constexpr FirmwareCharacter kOriginalFirmware{};
inline constexpr FirmwareCharacter kOwnFirmware{0.0005, 0.020, 0.05, 0.01};

class SimulatedPic {
  public:
    explicit SimulatedPic(FirmwareCharacter character) : character_(character) {}

    /// One byte arrives; what the PIC sends is appended to `out` with the time it is ready.
    void receive(double time, std::uint8_t byte);
    /// Handles what has become due; returns the time the PIC begins to answer, or a negative number.
    void advance(double time);
    void restart(double time);

    std::deque<double> answers;                     ///< times at which answers begin
    std::vector<protocols::EpuckActuators> obeyed;  ///< every actuator record it applied
    unsigned sessions = 0;                          ///< wake-ups taken
    bool in_session() const { return state_ == State::Records; }
    std::size_t pending() const { return buffer_.size(); }

  private:
    enum class State { Booting, Waiting, Configuration, Records };
    void consume(double time);
    void drop_part(double time);

    FirmwareCharacter character_;
    State state_ = State::Waiting;
    std::deque<std::uint8_t> buffer_;
    double busy_until_ = 0;  // booting, or until the waiting loop looks at the UART again
    double boot_began_ = 0;
    double last_byte_ = -1;
};

class SimulatedLine : public Transport {
  public:
    explicit SimulatedLine(FirmwareCharacter character) : pic(character) {}

    double now() override { return time_; }
    void sleep_until(double time) override;
    std::size_t read(std::span<std::uint8_t> into, double until) override;
    void write(std::span<const std::uint8_t> bytes) override;

    SimulatedPic pic;
    protocols::EpuckSensors sensors;  ///< what the PIC measures
    /// Faults by ordinal number of the byte on the line (0 is the first): how often it arrives (default 1),
    /// and what is added to its value.
    std::map<unsigned long, int> copies_to_pic;
    std::map<unsigned long, int> copies_to_linux;
    std::map<unsigned long, std::uint8_t> garble_to_pic;
    std::map<unsigned long, std::uint8_t> garble_to_linux;
    double late = 0;               ///< s added to the next answer, then reset to 0
    unsigned long sent = 0;        ///< bytes written by Linux
    unsigned long answered = 0;    ///< bytes put on the line by the PIC
    std::vector<double> restarts;  ///< times at which the PIC is reset, ascending

  private:
    struct Byte {
        double time;
        std::uint8_t value;
    };
    void run_until(double time);
    void put_answer(double begin);

    double time_ = 0;
    double wire_free_to_pic_ = 0;
    double wire_free_to_linux_ = 0;
    std::deque<Byte> to_pic_;
    std::deque<Byte> to_linux_;
};

}  // namespace puckloop::control
