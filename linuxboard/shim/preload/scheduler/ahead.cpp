#include "linuxboard/shim/preload/scheduler/ahead.h"

#include "linuxboard/shim/preload/host/program_memory.h"

#include <poll.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>

namespace puckloop::shim {

namespace {
/// As in the node: the tty layer reports room from 256 free bytes on.
constexpr std::uint32_t kReportedRoom = 256;
constexpr int kInput = POLLIN | POLLRDNORM;
constexpr int kOutput = POLLOUT | POLLWRNORM;
constexpr int kHungUp = POLLHUP | POLLERR;

bool input_ready(const wire::TtyView& tty) {
    if (tty.hung_up != 0) return true;
    if (tty.canonical != 0) return tty.has_line != 0;
    const std::uint32_t needed = tty.pause == 0 && tty.minimum > 0 ? tty.minimum : 1;
    return tty.readable >= needed;
}

/// For the node; whole at any instant at which the process may be killed. There must be room.
void note_done(const wire::Done& done) {
    wire::Channel& link = channel();
    link.done[link.done_count] = done;
    std::atomic_signal_fence(std::memory_order_release);
    ++link.done_count;
}

bool has_room_for_done() {
    return channel().done_count < wire::Channel::kMostDone;
}

bool read_here(const wire::Request& request, char* out, std::size_t capacity, std::int64_t now,
               Answer& answer) {
    wire::TtyView& tty = channel().tty;
    const auto nothing = [&](int error) {
        answer.result = error != 0 ? -1 : 0;
        answer.error = error;
        return true;
    };
    if (request.a == 0 || capacity < request.a) return false;
    if (tty.hung_up != 0) return nothing(0);
    if (tty.canonical != 0) return request.nonblocking != 0 && tty.has_line == 0 && nothing(EAGAIN);
    const std::uint32_t count = std::min(request.a, tty.readable);
    const bool never_waits = tty.minimum == 0 && tty.pause == 0;
    if (count == 0) {
        if (never_waits) return nothing(0);
        return request.nonblocking != 0 && nothing(EAGAIN);
    }
    const std::uint32_t minimum = std::min(std::max<std::uint32_t>(tty.minimum, 1), request.a);
    if (request.nonblocking == 0 && count < minimum) return false;
    if (count > tty.shown || !has_room_for_done()) return false;
    note_done({now, count, 0});
    const bool copied = copy_to_program(out, tty.input + tty.first, count);
    tty.first += count;
    tty.shown -= count;
    tty.readable -= count;
    if (!copied) return nothing(EFAULT);
    answer.result = count;
    answer.received = count;
    return true;
}

bool write_here(const void* data, std::size_t size, std::int64_t now, Answer& answer) {
    wire::Channel& link = channel();
    if (link.tty.raw_output == 0 || link.tty.hung_up != 0 || size == 0 || size > link.tty.room ||
        size > wire::Channel::kMostWritten - link.written_size || !has_room_for_done())
        return false;
    const auto length = static_cast<std::uint32_t>(size);
    std::memcpy(link.written + link.written_size, data, size);
    link.written_size += length;
    link.tty.room -= length;
    note_done({now, 0, length});
    answer.result = static_cast<std::int64_t>(size);
    return true;
}

bool poll_here(const wire::Request& request, const void* data, std::size_t size, void* out,
               std::size_t capacity, std::int64_t now, Answer& answer) {
    const wire::TtyView& tty = channel().tty;
    if (request.a == 0 || capacity < size) return false;
    const auto* asked = static_cast<const char*>(data);
    const auto entry_at = [asked](std::size_t offset) {
        wire::PollEntry entry;
        std::memcpy(&entry, asked + offset, sizeof entry);
        return entry;
    };
    const bool has_room = tty.hung_up != 0 || tty.room >= kReportedRoom;
    for (std::size_t at = 0; at < size; at += sizeof(wire::PollEntry)) {
        const wire::PollEntry entry = entry_at(at);
        if (entry.seen != 0) return false;  // edge-triggered: the node knows what is new
        if (!has_room && (entry.events & kOutput) != 0) return false;
    }
    const int happened = (input_ready(tty) ? kInput : 0) | kOutput | (tty.hung_up != 0 ? kHungUp : 0);
    for (std::size_t at = 0; at < size; at += sizeof(wire::PollEntry)) {
        wire::PollEntry entry = entry_at(at);
        entry.returned = static_cast<std::int16_t>(happened & (entry.events | kHungUp));
        answer.result += entry.returned != 0 ? 1 : 0;
        std::memcpy(static_cast<char*>(out) + at, &entry, sizeof entry);
    }
    answer.received = size;
    if (answer.result == 0) answer.time = std::max(now, request.deadline);
    return true;
}
}  // namespace

bool answer_ahead(const wire::Request& request, const void* data, std::size_t size, void* out,
                  std::size_t capacity, std::int64_t now, Answer& answer) {
    const wire::TtyView& tty = channel().tty;
    if (tty.usable == 0 || now >= tty.valid_until || page().ask_always != 0) return false;
    answer.time = now;
    switch (request.op) {
    case wire::Op::Read:
        return read_here(request, static_cast<char*>(out), capacity, now, answer);
    case wire::Op::Write:
        return write_here(data, size, now, answer);
    case wire::Op::Poll:
        return poll_here(request, data, size, out, capacity, now, answer) && answer.time < tty.valid_until;
    case wire::Op::InputQueue:
        answer.result = tty.readable;
        return true;
    default:
        return false;
    }
}

}  // namespace puckloop::shim
