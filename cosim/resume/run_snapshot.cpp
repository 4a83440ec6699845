#include "cosim/resume/run_snapshot.h"

#include "base/error.h"
#include "base/states/archive.h"
#include "cosim/core/message_state.h"
#include "cosim/resume/sealed_file.h"
#include "cosim/resume/state_file.h"

#include <fmt/format.h>

namespace puckloop::cosim {

namespace {

constexpr SealedKind kSnapshotKind{
    "puckloop snapshot of a run\n", kSnapshotFormat,        "snapshot", "snapshot",
    "a file written by --save",     std::uintmax_t{4} << 30};

/// Longest part of a build's id that is shown.
constexpr std::size_t kShown = 12;

}  // namespace

template <class Archive>
void state(Archive& archive, TraceRecord& record) {
    Message message{record.time, 0, record.payload};
    archive(message, record.link, record.sequence);
    archive.bounded(record.direction, Direction::FromA, Direction::FromB);
    archive.bounded(record.fault, FaultKind::None, FaultKind::Loopback);
    if constexpr (Archive::kLoads) {
        record.time = message.time;
        record.payload = std::move(message.payload);
    }
}

template <class Archive>
void state(Archive& archive, LinkStats& stats) {
    archive(stats.messages, stats.uart_frames, stats.uart_breaks, stats.uart_parity_errors,
            stats.uart_off_rate, stats.i2c_transactions, stats.i2c_bytes, stats.i2c_nacks, stats.i2c_bus_lost,
            stats.signals, stats.radio_frames, stats.radio_octets, stats.can_offers, stats.can_sent,
            stats.can_received, stats.can_errors, stats.packets, stats.packet_octets, stats.faults,
            stats.lost);
}

template <class Archive>
void state(Archive& archive, WireState& wire) {
    archive(wire.sequence, wire.brought_back, wire.faulty, wire.sent, wire.arrived);
}

template <class Archive>
void state(Archive& archive, NodeSnapshot& node) {
    archive(node.name, node.has_state, node.state, node.stop_seen);
}

template <class Archive>
void state(Archive& archive, StopSnapshot& stop) {
    archive(stop.stop.time, stop.stop.success, stop.stop.reason, stop.stop.together, stop.node);
}

template <class Archive>
void state(Archive& archive, RunSnapshot& run) {
    archive(run.build);
    archive.check(run.build == build_id(),
                  fmt::format("of another build of puckloop ({}...)", run.build.substr(0, kShown)));
    archive(run.origin);
    archive.bounded(run.time, 1, kNever - 1);
    archive(run.nodes, run.wires, run.stats, run.in_flight, run.hash, run.stop_requests, run.stop,
            run.unlinked, run.trace);
    archive.check(run.stats.size() == run.wires.size(), "another number of links");
    for (const auto* stops : {&run.stop_requests})
        for (const StopSnapshot& stop : *stops)
            archive.check(stop.node < run.nodes.size(), "a stop of no node");
    archive.check(!run.stop || run.stop->node < run.nodes.size(), "a stop of no node");
}

std::vector<std::uint8_t> encode(const RunSnapshot& snapshot) {
    std::vector<std::uint8_t> content;
    StateWriter writer(content);
    state(writer, const_cast<RunSnapshot&>(snapshot));  // one list for both directions; this one only reads
    return seal(kSnapshotKind, content);
}

RunSnapshot decode_snapshot(std::span<const std::uint8_t> bytes, const std::string& name) {
    const auto content = unseal(kSnapshotKind, bytes, name);
    try {
        StateReader reader(content);
        RunSnapshot snapshot;
        state(reader, snapshot);
        reader.end();
        return snapshot;
    } catch (const StateError& error) {
        throw InputError(name, "", error.what(), std::string(kSnapshotKind.expected) + " of this build");
    } catch (const std::bad_alloc&) {
        throw InputError(name, "", "needs more memory than there is", kSnapshotKind.expected);
    }
}

RunSnapshot read_snapshot(const std::filesystem::path& path) {
    return decode_snapshot(read_sealed(kSnapshotKind, path), path.string());
}

void write_snapshot(const std::filesystem::path& path, const RunSnapshot& snapshot) {
    write_whole(path, encode(snapshot));
}

}  // namespace puckloop::cosim
