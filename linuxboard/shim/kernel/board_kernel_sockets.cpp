// Sockets as open files: calls that wait until the network stack has something for them.

#include "linuxboard/shim/kernel/board_kernel.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;
using wire::Op;

namespace {

template <typename T>
std::string octets_of(const T& object) {
    std::string bytes(sizeof object, '\0');
    std::memcpy(bytes.data(), &object, sizeof object);
    return bytes;
}

Endpoint take_endpoint(std::string_view& data) {
    wire::SocketAddress address;
    std::memcpy(&address, data.data(), std::min(sizeof address, data.size()));
    data.remove_prefix(std::min(sizeof address, data.size()));
    return {address.address, address.port};
}

wire::SocketAddress as_address(const Endpoint& endpoint) {
    return {endpoint.address, endpoint.port, 0};
}

std::uint32_t wanted_beside(const SocketOptions& options) {
    const std::pair<bool, std::uint32_t> all[] = {{options.packet_info, wire::kWithPacketInfo},
                                                  {options.with_time_to_live, wire::kWithTimeToLive},
                                                  {options.with_service, wire::kWithService},
                                                  {options.time_stamp, wire::kWithTime},
                                                  {options.fine_time_stamp, wire::kWithFineTime}};
    std::uint32_t wanted = 0;
    for (const auto& [on, bit] : all)
        if (on) wanted |= bit;
    return wanted;
}

Time end_of(Time since, Time timeout) {
    return timeout == 0 ? kNever : since + timeout;
}

}  // namespace

bool BoardKernel::is_socket_call(Op op) {
    return op >= Op::Socket && op <= Op::Give;
}

void BoardKernel::open_socket(const wire::Request& request) {
    if (!network_) return finish(request.thread, -1, EAFNOSUPPORT, request.now);
    const int socket = network_->open(static_cast<SocketKind>(std::min(request.a, 3u)));
    finish_open(request.thread, new_socket_file(socket), request.now);
}

int BoardKernel::new_socket_file(int socket) {
    File file;
    file.open = true;
    file.kind = wire::DeviceKind::Socket;
    file.socket = socket;
    return place_file(file);
}

Time BoardKernel::socket_wake_time(const Waiting& waiting) const {
    const SocketOptions& options = network_->options(socket_of(waiting.request.handle));
    switch (waiting.request.op) {
    case Op::Receive:
    case Op::Accept:
        return end_of(waiting.since, options.receive_timeout);
    case Op::Send:
    case Op::Connect:
        return end_of(waiting.since, options.send_timeout);
    default:
        return kNever;
    }
}

bool BoardKernel::attempt_socket(std::uint32_t thread, Waiting& waiting, Time now) {
    const wire::Request& request = waiting.request;
    const int socket = socket_of(request.handle);
    NetworkStack& stack = *network_;
    const bool waits = request.nonblocking == 0;
    const bool late = waits && now >= socket_wake_time(waiting);
    std::string_view data = waiting.data;
    const auto done = [&](std::int64_t result, int error = 0, std::string answer = {}) {
        finish(thread, result, error, now, std::move(answer));
        return true;
    };
    switch (request.op) {
    case Op::Bind: {
        const int error = stack.bind(socket, take_endpoint(data));
        return done(0, error);
    }
    case Op::Listen:
        return done(0, stack.listen(socket, static_cast<int>(request.a)));
    case Op::Connect: {
        int error = 0;
        if (waiting.progress != 0) {
            error = stack.connecting(socket);
        } else if (request.a == 1) {
            stack.disconnect(socket);
        } else {
            error = stack.connect(socket, take_endpoint(data), now);
            // The rest of a call that a signal interrupted.
            if (error == EALREADY && waits) error = EINPROGRESS;
        }
        if (error != EINPROGRESS || !waits || late) return done(0, error);
        waiting.progress = 1;
        return false;
    }
    case Op::Accept: {
        if (!stack.listening(socket)) return done(-1, EINVAL);
        const int connection = stack.accept(socket);
        if (connection < 0) return waits && !late ? false : done(-1, EAGAIN);
        Endpoint peer;
        stack.name_of(connection, true, peer);
        finish_open(thread, new_socket_file(connection), now, octets_of(as_address(peer)));
        return true;
    }
    case Op::Send: {
        std::optional<Endpoint> to;
        if (request.a == 1) to = take_endpoint(data);
        data.remove_prefix(std::min(waiting.progress, data.size()));
        std::size_t taken = 0;
        int error = stack.send(socket, to, data, taken, now, (request.b & wire::kSendMore) != 0);
        waiting.progress += taken;
        const bool some = waiting.progress > 0;
        if (error == EAGAIN || (error == 0 && taken < data.size())) {
            if (waits && !late) return false;
            error = some ? 0 : EAGAIN;
        }
        if (some && error != 0) stack.keep_error(socket, error);  // for the next call, as Linux does
        return done(static_cast<std::int64_t>(waiting.progress), some ? 0 : error);
    }
    case Op::Receive:
        return attempt_receive(thread, waiting, now, late);
    case Op::Shutdown:
        return done(0, stack.shutdown(socket, static_cast<int>(request.a), now));
    case Op::SetOption:
        return done(
            0, stack.set_option(socket, static_cast<int>(request.a), static_cast<int>(request.b), data, now));
    case Op::GetOption: {
        std::string value;
        const int error =
            stack.get_option(socket, static_cast<int>(request.a), static_cast<int>(request.b), value);
        return done(0, error, std::move(value));
    }
    case Op::SocketName: {
        Endpoint name;
        const int error = stack.name_of(socket, request.a == 1, name);
        return done(0, error, octets_of(as_address(name)));
    }
    case Op::SocketQueue:
        return done(
            static_cast<std::int64_t>(request.a == 1 ? stack.unsent(socket) : stack.readable(socket)));
    case Op::Give: {
        Passed passed{request.handle, {}};
        std::memcpy(&passed.file, data.data(), std::min(sizeof passed.file, data.size()));
        passed_.push_back(passed);
        share(request.handle);
        return done(0);
    }
    default:
        return done(-1, ENOSYS);
    }
}

/// The reference goes on to the process that takes it.
void BoardKernel::take_socket(const wire::Request& request, std::string_view data) {
    wire::PassedFile wanted;
    std::memcpy(&wanted, data.data(), std::min(sizeof wanted, data.size()));
    const auto found = std::find_if(passed_.begin(), passed_.end(),
                                    [&](const Passed& passed) { return passed.file.inode == wanted.inode; });
    if (found == passed_.end()) return finish(request.thread, -1, ENOENT, request.now);
    const Passed passed = *found;
    passed_.erase(found);
    finish_open(request.thread, passed.handle, request.now, octets_of(passed.file));
}

bool BoardKernel::join_pieces(const wire::Request& request, std::string& data) {
    if ((request.b & wire::kSendPart) != 0) {
        begun_[request.thread] += data;
        finish(request.thread, 0, 0, request.now);
        return false;
    }
    if (const auto begun = begun_.extract(request.thread)) data.insert(0, begun.mapped());
    return true;
}

bool BoardKernel::attempt_receive(std::uint32_t thread, Waiting& waiting, Time now, bool late) {
    const wire::Request& request = waiting.request;
    const int socket = socket_of(request.handle);
    if ((request.b & wire::kReceiveRest) != 0) {
        std::string& rest = rest_[thread];
        std::string part = rest.substr(0, wire::kMaximumData);
        rest.erase(0, part.size());
        const auto count = static_cast<std::int64_t>(part.size());
        finish(thread, count, 0, now, std::move(part));
        return true;
    }
    const bool peek = (request.b & wire::kReceivePeek) != 0;
    const bool all = (request.b & wire::kReceiveAll) != 0 && network_->is_stream(socket) && !peek;
    NetworkStack::Received received;
    int error = network_->receive(socket, request.a - waiting.gathered.size(), peek, received, now);
    // Of datagrams the end (shutdown) is for those alone that wait for one.
    const bool none =
        error == 0 && received.from == Endpoint{} && received.size == 0 && !network_->is_stream(socket);
    if (none && request.nonblocking != 0) error = EAGAIN;
    waiting.gathered += received.data;
    const bool some = !waiting.gathered.empty();
    const bool waits = request.nonblocking == 0 && !late;
    if (error == EAGAIN && waits) return false;
    const bool at_end = error != 0 || received.data.empty() || request.a == 0;
    if (all && waits && !at_end && waiting.gathered.size() < request.a) return false;
    const auto enough = static_cast<std::size_t>(network_->options(socket).low_water);  // SO_RCVLOWAT
    const bool low =
        network_->is_stream(socket) && waiting.gathered.size() < std::min<std::size_t>(enough, request.a);
    if (low && waits && !peek && !at_end) return false;
    if (error != 0 && !some) {
        finish(thread, -1, error, now);
        return true;
    }
    const wire::SocketReceived head{as_address(received.from),
                                    static_cast<std::uint32_t>(received.size),
                                    received.to,
                                    wanted_beside(network_->options(socket)),
                                    received.time_to_live,
                                    received.service,
                                    0,
                                    received.time};
    const auto size = static_cast<std::int64_t>(waiting.gathered.size());
    std::string answer = octets_of(head) + waiting.gathered;
    if (answer.size() > wire::kMaximumData) {
        rest_[thread] = answer.substr(wire::kMaximumData);
        answer.resize(wire::kMaximumData);
    }
    finish(thread, size, 0, now, std::move(answer));
    return true;
}

std::int16_t BoardKernel::socket_events(wire::PollEntry& entry) const {
    const int socket = socket_of(entry.handle);
    const std::uint32_t activity = network_->activity(socket);
    const bool news = entry.seen == 0 || entry.seen != activity;
    if (entry.seen != 0) entry.seen = activity;
    return news ? static_cast<std::int16_t>(network_->events(socket)) : std::int16_t{0};
}

void BoardKernel::deliver_packet(const cosim::Packet& packet, Time now) {
    if (!network_) return;
    network_->receive_packet(packet.octets.view(), now);
    attempt_all(now);
}

std::vector<PacketOut> BoardKernel::take_packets() {
    return network_ ? network_->take_packets() : std::vector<PacketOut>{};
}

}  // namespace puckloop::linuxboard
