#include "cosim/remote/protocol.h"

#include <fmt/format.h>

namespace puckloop::cosim::protocol {

namespace {

// Smallest encodings, to refuse absurd counts before memory is taken for them.
constexpr std::size_t kSmallestMessage = 8 + 2 + 1 + 2 + 8;
constexpr std::size_t kSmallestPort = 4 + 1;
constexpr std::size_t kSmallestPortState = 8 + 8 + 1;
constexpr std::size_t kPortEcho = 8 + 8 + 8 + 1;

/// Opens a message, and sets its length when it goes out of scope.
class Frame {
  public:
    Frame(Bytes& bytes, Kind kind) : bytes_(bytes), writer(bytes) {
        bytes.assign(kLengthBytes, 0);
        writer.u8(static_cast<std::uint8_t>(kind));
    }
    ~Frame() {
        const auto size = static_cast<std::uint32_t>(bytes_.size() - kLengthBytes);
        for (std::size_t i = 0; i < kLengthBytes; ++i)
            bytes_[i] = static_cast<std::uint8_t>(size >> (8 * i));
    }
    Frame(const Frame&) = delete;
    Frame& operator=(const Frame&) = delete;

  private:
    Bytes& bytes_;

  public:
    ByteWriter writer;
};

ByteReader open(std::span<const std::uint8_t> body, Kind expected) {
    ByteReader reader(body);
    if (reader.enumerator(Kind::Error) != expected) throw CodecError("message of another kind");
    return reader;
}

void write_state(ByteWriter& writer, const NodeState& state) {
    writer.u32(static_cast<std::uint32_t>(state.ports.size()));
    for (const PortState& port : state.ports) {
        writer.time(port.earliest_output);
        writer.time(port.lookahead);
        writer.u8(port.begun.has_value());
        if (port.begun) writer.time(*port.begun);
    }
    writer.u8(state.stop.has_value());
    if (state.stop) {
        writer.time(state.stop->time);
        writer.u8(state.stop->success);
        writer.text(state.stop->reason);
        writer.u32(state.stop->together);
    }
    writer.time(state.wound_up);
    writer.u8(state.runs_ahead);
    writer.u8(state.bounded);
    writer.time(state.horizon);
}

void read_state(ByteReader& reader, NodeState& state) {
    state.ports.resize(reader.count(kSmallestPortState));
    for (PortState& port : state.ports) {
        port.earliest_output = reader.time();
        port.lookahead = reader.time();
        port.begun.reset();
        if (reader.boolean()) port.begun = reader.time();
    }
    state.stop.reset();
    if (reader.boolean()) {
        Stop stop;
        stop.time = reader.time();
        stop.success = reader.boolean();
        stop.reason = reader.text();
        stop.together = reader.u32();
        state.stop = stop;
    }
    state.wound_up = reader.time();
    state.runs_ahead = reader.boolean();
    state.bounded = reader.boolean();
    state.horizon = reader.time();
}

void write_messages(ByteWriter& writer, const std::vector<Message>& messages) {
    writer.u32(static_cast<std::uint32_t>(messages.size()));
    for (const Message& message : messages)
        writer.message(message);
}

void read_messages(ByteReader& reader, std::vector<Message>& messages) {
    const std::size_t count = reader.count(kSmallestMessage);
    messages.clear();
    messages.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
        messages.push_back(reader.message());
}

}  // namespace

void write_hello(Bytes& bytes, const Hello& hello) {
    Frame frame(bytes, Kind::Hello);
    frame.writer.u32(kVersion);
    frame.writer.text(hello.name);
    frame.writer.text(hello.json);
}

void write_ready(Bytes& bytes, const Ready& ready) {
    Frame frame(bytes, Kind::Ready);
    frame.writer.u32(static_cast<std::uint32_t>(ready.ports.size()));
    for (const Port& port : ready.ports) {
        frame.writer.text(port.name);
        frame.writer.u8(static_cast<std::uint8_t>(port.kind));
    }
    write_state(frame.writer, ready.state);
    frame.writer.u8(ready.has_state);
}

void write_grant(Bytes& bytes, Reach reach, const std::vector<Message>& inbox,
                 std::span<const PortEcho> echoes) {
    Frame frame(bytes, Kind::Grant);
    frame.writer.time(reach.sure);
    frame.writer.time(reach.until);
    frame.writer.time(reach.ahead);
    write_messages(frame.writer, inbox);
    frame.writer.u32(static_cast<std::uint32_t>(echoes.size()));
    for (const PortEcho& echo : echoes) {
        frame.writer.time(echo.flight);
        frame.writer.time(echo.latency);
        frame.writer.time(echo.back);
        frame.writer.u8(echo.is_uart);
    }
}

void write_done(Bytes& bytes, const Advanced& advanced, const NodeState& state,
                const std::vector<Message>& outbox) {
    Frame frame(bytes, Kind::Done);
    frame.writer.time(advanced.reached);
    frame.writer.time(advanced.ahead);
    frame.writer.u32(static_cast<std::uint32_t>(advanced.sure));
    write_state(frame.writer, state);
    write_messages(frame.writer, outbox);
}

void write_wind_up(Bytes& bytes, int signal) {
    Frame frame(bytes, Kind::WindUp);
    frame.writer.u8(static_cast<std::uint8_t>(signal));
}

void write_save(Bytes& bytes) {
    Frame frame(bytes, Kind::Save);
}

void write_state(Bytes& bytes, const Bytes& state) {
    Frame frame(bytes, Kind::State);
    bytes.insert(bytes.end(), state.begin(), state.end());
}

void write_load(Bytes& bytes, Time time, const Bytes& state) {
    Frame frame(bytes, Kind::Load);
    frame.writer.time(time);
    bytes.insert(bytes.end(), state.begin(), state.end());
}

void write_finish(Bytes& bytes) {
    Frame frame(bytes, Kind::Finish);
}

void write_report(Bytes& bytes, const std::string& json) {
    Frame frame(bytes, Kind::Report);
    frame.writer.text(json);
}

void write_error(Bytes& bytes, const Error& error) {
    Frame frame(bytes, Kind::Error);
    frame.writer.u8(error.input);
    frame.writer.text(error.text);
}

Kind kind_of(std::span<const std::uint8_t> body) {
    return ByteReader(body).enumerator(Kind::Error);
}

Hello read_hello(std::span<const std::uint8_t> body) {
    ByteReader reader = open(body, Kind::Hello);
    const std::uint32_t version = reader.u32();
    if (version != kVersion)
        throw CodecError(fmt::format("protocol version {}, this program speaks {}", version, kVersion));
    Hello hello;
    hello.name = reader.text();
    hello.json = reader.text();
    reader.end();
    return hello;
}

Ready read_ready(std::span<const std::uint8_t> body) {
    ByteReader reader = open(body, Kind::Ready);
    Ready ready;
    ready.ports.resize(reader.count(kSmallestPort));
    for (Port& port : ready.ports) {
        port.name = reader.text();
        port.kind = reader.enumerator(PortKind::Network);
    }
    read_state(reader, ready.state);
    ready.has_state = reader.boolean();
    reader.end();
    if (ready.state.ports.size() != ready.ports.size()) throw CodecError("state of another number of ports");
    return ready;
}

void read_grant(std::span<const std::uint8_t> body, Grant& grant) {
    ByteReader reader = open(body, Kind::Grant);
    grant.reach.sure = reader.time();
    grant.reach.until = reader.time();
    grant.reach.ahead = reader.time();
    read_messages(reader, grant.inbox);
    grant.echoes.resize(reader.count(kPortEcho));
    for (PortEcho& echo : grant.echoes) {
        echo.flight = reader.time();
        echo.latency = reader.time();
        echo.back = reader.time();
        echo.is_uart = reader.boolean();
    }
    reader.end();
}

int read_wind_up(std::span<const std::uint8_t> body) {
    ByteReader reader = open(body, Kind::WindUp);
    const int signal = reader.u8();
    reader.end();
    return signal;
}

Advanced read_done(std::span<const std::uint8_t> body, std::size_t ports, NodeState& state,
                   std::vector<Message>& outbox) {
    ByteReader reader = open(body, Kind::Done);
    Advanced advanced;
    advanced.reached = reader.time();
    advanced.ahead = reader.time();
    advanced.sure = reader.u32();
    read_state(reader, state);
    if (state.ports.size() != ports) throw CodecError("state of another number of ports");
    read_messages(reader, outbox);
    reader.end();
    if (advanced.ahead < advanced.reached || advanced.sure > outbox.size())
        throw CodecError("less than nothing foreseen");
    return advanced;
}

Bytes read_state(std::span<const std::uint8_t> body) {
    const ByteReader reader = open(body, Kind::State);
    const auto state = body.last(reader.left());
    return {state.begin(), state.end()};
}

Load read_load(std::span<const std::uint8_t> body) {
    ByteReader reader = open(body, Kind::Load);
    Load load;
    load.time = reader.time();
    const auto state = body.last(reader.left());
    load.state.assign(state.begin(), state.end());
    return load;
}

std::string read_report(std::span<const std::uint8_t> body) {
    ByteReader reader = open(body, Kind::Report);
    std::string json = reader.text();
    reader.end();
    return json;
}

Error read_error(std::span<const std::uint8_t> body) {
    ByteReader reader = open(body, Kind::Error);
    Error error;
    error.input = reader.boolean();
    error.text = reader.text();
    reader.end();
    return error;
}

}  // namespace puckloop::cosim::protocol
