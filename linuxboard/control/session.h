#pragma once
// One session with the robot's PIC over the serial records of protocols/serial/epuck_serial.h, with recovery
// the original programs lack: lost, late, repeated or garbled bytes, and a restart of either side.
//
// The records have no header and no check, so all rests on three observations about the PIC (fact sheet 1.4):
// it answers as soon as, and only when, it has the last byte it waits for; it takes any byte as wake-up and
// zeros are a safe configuration and a safe actuator record (wheels stopped, LEDs off); and it answers within
// milliseconds except out of its waiting loop, where it may take an eighth of a second.
//  * Exchange: the last byte of each actuator record is held back for a moment. A PIC that answers before it
//    comes holds surplus bytes: the records have slipped against each other. It has then
//    obeyed parts of two records, so zeros follow at once.
//  * No answer: the PIC misses bytes, waits for a session, or is restarting. Zeros are sent singly, each
//  given
//    time for an answer, until one comes.
//  * Proof: after an answer to zeros, zeros are sent singly once more. Inside a session the PIC answers at
//    once, so the byte it answers to is the last of its record, and both sides are aligned.

#include "linuxboard/control/devices/transport.h"
#include "protocols/serial/epuck_serial.h"

#include <functional>
#include <optional>
#include <string>

namespace puckloop::control {

/// All in seconds.
struct SessionTiming {
    double start_answer = 0.25;    ///< wake-up to the end of the first record: waiting loop 122 ms + wire
    double answer = 0.060;         ///< actuator record to the first byte of the answer
    double answer_to_word = 0.25;  ///< likewise after a record that sends a word: the original takes 115 ms
    double silence = 0.020;        ///< this long without a byte ends a record
    double hold_back = 0.004;      ///< wait before an actuator record's last byte
    double step = 0.010;  ///< between single zeros; below the 20 ms after which our firmware drops a part
    double pause_first = 0.1;  ///< between rounds of zeros, doubled up to ...
    double pause_last = 0.8;
};

struct SessionCounters {
    unsigned long frames = 0;     ///< actuator records sent, the end record not counted
    unsigned long records = 0;    ///< good sensor records
    unsigned long no_answer = 0;  ///< records not answered at all
    unsigned long short_records = 0;
    unsigned long implausible = 0;  ///< right length, impossible content
    unsigned long slips = 0;        ///< answers that came before the last byte was sent
    unsigned long stray_bytes = 0;  ///< bytes received that belong to no record
    unsigned long resyncs = 0;      ///< re-synchronisations begun
    double longest_gap = 0;         ///< s between good records
};

class Session {
  public:
    using Log = std::function<void(const std::string&)>;

    /// `interrupted` ends start() and resync() early, after at least one try.
    Session(Transport& transport, Log log, std::function<bool()> interrupted, SessionTiming timing = {});

    /// Wakes the PIC and gets the first record. False when nothing came until `give_up` or interrupted.
    bool start(double give_up);
    /// Sends one actuator record and waits for its answer. Empty when the answer was lost or garbled; then
    /// ask lost() whether the two sides are out of step.
    std::optional<protocols::EpuckSensors> exchange(const protocols::EpuckActuators& actuators);
    bool lost() const { return lost_; }
    /// Brings both sides into step again; the robot stands still meanwhile. False as start().
    bool resync(double give_up);
    /// Sends the end record: the PIC stops the robot and waits for the next session. No answer.
    void end();

    /// The newest good record, if any, and when it came.
    const std::optional<protocols::EpuckSensors>& newest() const { return newest_; }
    double newest_time() const { return newest_time_; }
    const SessionCounters& counters() const { return counters_; }

  private:
    enum class Round { Silent, Answered, Proven };

    std::size_t discard(double silence);
    std::size_t receive(std::span<std::uint8_t> record, double first_byte_until);
    bool accept(std::span<const std::uint8_t> record);
    Round round_of_zeros();

    Transport& transport_;
    Log log_;
    std::function<bool()> interrupted_;
    SessionTiming timing_;
    SessionCounters counters_;
    std::optional<protocols::EpuckSensors> newest_;
    double newest_time_ = 0;
    bool lost_ = false;
    int garbled_in_a_row_ = 0;
};

}  // namespace puckloop::control
