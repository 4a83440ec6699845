#pragma once
// What the conductor and a node process say to each other: messages of a 32-bit length and a body, all
// little-endian, in rings of shared memory (ring_stream.h).

#include "cosim/core/codec.h"
#include "cosim/schedule/node_handle.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace puckloop::cosim::protocol {

inline constexpr std::uint32_t kVersion = 4;
inline constexpr std::size_t kLengthBytes = 4;
/// Longer messages are damage, not work: a millisecond of the busiest link is some kilobytes.
inline constexpr std::uint32_t kLongest = 64u << 20;
/// Where a node process finds the memory that it shares with the conductor (node_processes.h); the next
/// descriptor is the memory that all processes of the run share.
inline constexpr int kDescriptor = 3;

enum class Kind : std::uint8_t {
    Hello,   ///< to the node: version, name, description
    Ready,   ///< from the node: ports, state, whether it can be saved
    Grant,   ///< to the node: reach, inbox, echoes
    Done,    ///< from the node: how far it came, state, outbox
    WindUp,  ///< to the node: signal
    Save,    ///< to the node: nothing
    State,   ///< from the node: its whole state
    Load,    ///< to the node: the time, its state then; answered by Done
    Finish,  ///< to the node: nothing
    Report,  ///< from the node: JSON text
    Error,   ///< from the node: whether the user's input is to blame, text
};

struct Hello {
    std::string name;
    std::string json;
};
struct Ready {
    std::vector<Port> ports;
    NodeState state;
    bool has_state = false;
};
struct Load {
    Time time = 0;
    Bytes state;
};
struct Grant {
    Reach reach;
    std::vector<Message> inbox;
    std::vector<PortEcho> echoes;
};
struct Error {
    bool input = false;
    std::string text;
};

/// Each writes one whole message, length included, in place of what `bytes` held.
void write_hello(Bytes& bytes, const Hello& hello);
void write_ready(Bytes& bytes, const Ready& ready);
void write_grant(Bytes& bytes, Reach reach, const std::vector<Message>& inbox,
                 std::span<const PortEcho> echoes);
void write_done(Bytes& bytes, const Advanced& advanced, const NodeState& state,
                const std::vector<Message>& outbox);
void write_wind_up(Bytes& bytes, int signal);
void write_save(Bytes& bytes);
void write_state(Bytes& bytes, const Bytes& state);
void write_load(Bytes& bytes, Time time, const Bytes& state);
void write_finish(Bytes& bytes);
void write_report(Bytes& bytes, const std::string& json);
void write_error(Bytes& bytes, const Error& error);

/// Each reads a body (kind first, without the length); throws CodecError.
Kind kind_of(std::span<const std::uint8_t> body);
Hello read_hello(std::span<const std::uint8_t> body);
Ready read_ready(std::span<const std::uint8_t> body);
/// Into `grant`, whose memory is reused.
void read_grant(std::span<const std::uint8_t> body, Grant& grant);
int read_wind_up(std::span<const std::uint8_t> body);
/// Into `state` and `outbox` (reused) of a node with `ports` ports.
Advanced read_done(std::span<const std::uint8_t> body, std::size_t ports, NodeState& state,
                   std::vector<Message>& outbox);
Bytes read_state(std::span<const std::uint8_t> body);
Load read_load(std::span<const std::uint8_t> body);
std::string read_report(std::span<const std::uint8_t> body);
Error read_error(std::span<const std::uint8_t> body);

}  // namespace puckloop::cosim::protocol
