#pragma once
// One class for each protocol that decode.h knows. All take rows in the order of the trace.

#include "cosim/trace/trace_row.h"
#include "protocols/infrared/ircom.h"
#include "protocols/radio/lmx9820_packet.h"
#include "protocols/radio/xbee_frame.h"
#include "traces/can_frames.h"
#include "traces/decoders/decode.h"
#include "traces/fault_marks.h"
#include "traces/i2c_transfers.h"
#include "traces/received.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Takes both senders of one UART link.
class UartDecoder {
  public:
    virtual ~UartDecoder() = default;
    virtual void add(const cosim::TraceRow& row, const cosim::UartFrame& frame) = 0;
    virtual void end() = 0;
    /// How the receivers of both ends are set, until frames say otherwise.
    void assume(const protocols::UartReceiver& receiver) { assumed_ = receiver; }

  protected:
    std::vector<protocols::ReceivedCharacter> receive(LineReceiver& line, const cosim::TraceRow& row,
                                                      const cosim::UartFrame& frame) const {
        if (assumed_) line.assume(*assumed_);
        return line.take(row, frame);
    }

  private:
    std::optional<protocols::UartReceiver> assumed_;
};

std::string hex_bytes(const std::vector<std::uint8_t>& bytes);

/// Bytes of one sender that belong together, as a receiver takes them (received.h).
struct ByteRun {
    std::vector<std::uint8_t> bytes;
    std::vector<std::string> errors;  ///< with the place in the run: "byte 3: fault flip"
    cosim::Time begin = 0, end = 0;
    bool empty() const { return bytes.empty() && errors.empty(); }
    /// `characters`: what the receiver made of the frame; without any it leaves its error only.
    void add(const cosim::TraceRow& row, const cosim::UartFrame& frame,
             const std::vector<protocols::ReceivedCharacter>& characters);
};

class BytesDecoder : public UartDecoder {
  public:
    explicit BytesDecoder(TakeFrame take) : take_(std::move(take)) {}
    void add(const cosim::TraceRow& row, const cosim::UartFrame& frame) override;
    void end() override;

  private:
    void hand_over(const std::string& from);
    TakeFrame take_;
    std::string link_;
    std::map<std::string, ByteRun> runs_;
    std::map<std::string, LineReceiver> receivers_;
};

/// Records between a robot's Linux board and its main board. They have neither header nor check: a record is
/// complete by its count, in the order wake-up and configuration, then actuators and sensors in turn, until
/// actuators with reset 'R'. The main board answers complete records only, so what is left of the other side
/// when it begins to answer was out of step.
class EpuckDecoder : public UartDecoder {
  public:
    explicit EpuckDecoder(TakeFrame take) : take_(std::move(take)) {}
    void add(const cosim::TraceRow& row, const cosim::UartFrame& frame) override;
    void end() override;

  private:
    enum class Expect : std::uint8_t { Session, Actuators };
    void from_linux(const std::string& from);
    void from_board(const std::string& from);
    void give(ByteRun& run, const std::string& from, DecodedFrame frame);
    void give_rest(ByteRun& run, const std::string& from, const std::string& what);
    TakeFrame take_;
    std::string link_, linux_name_ = "?", board_name_ = "?";
    ByteRun linux_, board_;
    LineReceiver from_linux_line_, from_board_line_;
    Expect expect_ = Expect::Session;
};

class XBeeDecoder : public UartDecoder {
  public:
    explicit XBeeDecoder(TakeFrame take) : take_(std::move(take)) {}
    void add(const cosim::TraceRow& row, const cosim::UartFrame& frame) override;
    void end() override;

  private:
    struct Side {
        protocols::XBeeReader reader{protocols::XBeeApiMode::Escaped};
        ByteRun run;
        LineReceiver line;
    };
    void take(const std::string& from, Side& side, const cosim::TraceRow& row, const cosim::UartFrame& frame,
              const protocols::ReceivedCharacter& character);
    void give(const std::string& from, Side& side, const protocols::XBeeReading& reading);
    TakeFrame take_;
    std::string link_;
    std::map<std::string, Side> sides_;
};

/// Packets between a main board and its Bluetooth module, and what passes between them transparently.
class LmxDecoder : public UartDecoder {
  public:
    explicit LmxDecoder(TakeFrame take) : take_(std::move(take)) {}
    void add(const cosim::TraceRow& row, const cosim::UartFrame& frame) override;
    void end() override;

  private:
    struct Side {
        protocols::LmxReader reader;
        ByteRun packet, plain;
        LineReceiver line;
    };
    void take(const std::string& from, Side& side, const cosim::TraceRow& row, const cosim::UartFrame& frame,
              const protocols::ReceivedCharacter& character);
    void give_plain(const std::string& from, ByteRun& run);
    void give_packet(const std::string& from, Side& side, const protocols::LmxPacket& packet);
    TakeFrame take_;
    std::string link_;
    std::map<std::string, Side> sides_;
};

/// START to STOP, repeated STARTs included, with the names of known devices and registers.
class I2cDecoder {
  public:
    I2cDecoder(const FaultMarks& marks, TakeFrame take);
    void add(const cosim::TraceRow& row, const cosim::I2cPhase& phase) { transfers_.add(row, phase); }
    void end();

  private:
    struct Open {
        DecodedFrame frame;
        bool begun = false;
        std::uint8_t address = 0;
        bool reads = false;
        std::vector<std::uint8_t> bytes;
        std::map<std::uint8_t, int> pointer;  ///< register selected last, by address
    };
    void step(const I2cStep& step);
    void end_part(Open& open);
    void give(Open& open);
    const FaultMarks& marks_;
    TakeFrame take_;
    I2cTransfers transfers_;
    std::map<std::string, Open> links_;
};

/// Infra-red frames at the emitters of a range-and-bearing board, where the scenario records them.
class RabDecoder {
  public:
    explicit RabDecoder(TakeFrame take) : take_(std::move(take)) {}
    /// The signal may be one of its light, by its name alone.
    static bool is_of_frames(std::string_view signal) { return signal.starts_with(kEmitter); }
    /// True if the row is a range-and-bearing emitter's.
    bool add(const cosim::TraceRow& row, const cosim::Signal& signal);
    void end();

  private:
    static constexpr std::string_view kEmitter = "emitter";  // and its number
    static constexpr int kEmitters = 12;
    struct Emitter {
        cosim::Time begin = 0, edge = 0;
        bool level = false;
        std::string chips;
    };
    struct Board {
        std::array<Emitter, kEmitters> emitters;
    };
    void edge(Emitter& emitter, cosim::Time time, bool level);
    void close(const std::string& link, const std::string& from, Board& board, cosim::Time now);
    TakeFrame take_;
    std::map<std::pair<std::string, std::string>, Board> boards_;
};

/// IRcom words that main boards and TAMs send, where the scenario records them.
class IrcomDecoder {
  public:
    explicit IrcomDecoder(TakeFrame take) : take_(std::move(take)) {}
    /// The signal may be one of its light, by its name alone.
    static bool is_of_frames(std::string_view signal) {
        return signal.starts_with(kPulse) || signal == kBarrier;
    }
    /// True if the row is a sender's light.
    bool add(const cosim::TraceRow& row, const cosim::Signal& signal);
    void end();

  private:
    static constexpr std::string_view kPulse = "pulse", kBarrier = "proximity_emit";
    struct Sender {
        std::map<std::string, bool> lit;  ///< by emitter; each lights the whole
        cosim::Time last = 0;
        protocols::IrcomReader reader;
    };
    void give(const std::string& link, const std::string& from, const protocols::IrcomReading& reading);
    TakeFrame take_;
    std::map<std::pair<std::string, std::string>, Sender> senders_;
};

/// A fault that is on no frame.
void decode_mark(const FaultMark& mark, const TakeFrame& take);

void decode_can(const cosim::TraceRow& row, const CanOnBus& seen, const TakeFrame& take);
/// Once for each packet: where it is sent.
void decode_packet(const cosim::TraceRow& row, const cosim::Packet& packet, const TakeFrame& take);
void decode_radio(const cosim::TraceRow& row, const cosim::RadioFrame& frame, const TakeFrame& take);

}  // namespace puckloop::tools
