// The program's processes among themselves: made, replaced, signalled, ended, waited for.

#include "base/error.h"
#include "linuxboard/shim/node/linux_node.h"

#include <fmt/format.h>

#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <new>
#include <utility>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;
using wire::Op;
using wire::ProcessEntry;

namespace {
constexpr double kChildPatience = 10.0;  // wall-clock seconds until a new process must have reported
}

LinuxNode::Client* LinuxNode::client_at(std::uint32_t slot) {
    const auto found = std::find_if(clients_.begin(), clients_.end(),
                                    [slot](const auto& client) { return client->slot == slot; });
    return found == clients_.end() ? nullptr : found->get();
}

LinuxNode::Client* LinuxNode::first(Client::State state) {
    Client* best = nullptr;
    for (const auto& client : clients_)
        if (client->state == state && (best == nullptr || due(*client) < due(*best))) best = client.get();
    return best;
}

Time LinuxNode::due(const Client& client) {
    switch (client.state) {
    case Client::State::Asking:
        return client.request.now;
    case Client::State::Waiting:
        if (!client.finished.empty()) return client.request.now;
        if (client.leaving) return kNever;
        return std::min({client.request.wait_until, client.signals_at, client.woken_at});
    case Client::State::Starting:
    case Client::State::Running:
        break;
    }
    return kNever;
}

void LinuxNode::deal_out() {
    for (FinishedCall& call : kernel_.take_finished()) {
        Client* client = client_at(slot_of(call.header.thread));
        if (client == nullptr) continue;
        const auto handle = static_cast<int>(call.header.result);
        // A process that was passed what it has already goes on with one reference.
        if (call.opens && call.header.error == 0 && !client->handles.insert(handle).second)
            kernel_.release(handle, call.header.time);
        client->finished.push_back(std::move(call));
    }
}

bool LinuxNode::wake_ready(Time now) {
    deal_out();
    const auto ready = std::find_if(clients_.begin(), clients_.end(), [this, now](const auto& client) {
        return client->state == Client::State::Waiting && goes_on(*client) <= now;
    });
    if (ready == clients_.end()) return false;
    if ((*ready)->leaving) {
        must_be_final();
        client_ended(**ready, now);
    } else {
        answer(**ready, now);
    }
    return true;
}

void LinuxNode::finish(Client& client, std::int64_t result, int error, std::string data) {
    FinishedCall call;
    call.header.thread = client.request.thread;
    call.header.error = error;
    call.header.result = error != 0 ? -1 : result;
    call.header.time = client.request.now;
    call.header.length = static_cast<std::uint32_t>(data.size());
    call.data = std::move(data);
    client.finished.push_back(std::move(call));
}

bool LinuxNode::handle_family(Client& client) {
    const wire::Request& request = client.request;
    switch (request.op) {
    case Op::Hello:
        hello(client);
        return true;
    case Op::Fork:
        fork(client);
        return true;
    case Op::Forked:
        hear_child(client);
        finish(client, 0);
        return true;
    case Op::Exec:
        client.inherited = client.data;
        finish(client, 0);
        return true;
    case Op::Changed:
        changed(&client, request.now);
        finish(client, 0);
        return true;
    case Op::Kill:
        // The sender goes on for a moment: what it sends together arrives together, as on one processor.
        send_signal(request.a, static_cast<int>(request.b), request.now + spec_.charges.thread,
                    {entry(client.slot).number, 0, 0});
        finish(client, 0);
        return true;
    case Op::Reap:
        if (request.a < wire::kMaximumProcesses && client_at(request.a) == nullptr)
            entry(request.a).state = ProcessEntry::Free;
        finish(client, 0);
        return true;
    default:
        return false;
    }
}

void LinuxNode::hello(Client& client) {
    // Another program in the same process: its other threads and what they waited for are gone.
    kernel_.forget(client.slot, client.request.now);
    client.finished.clear();
    finish(client, 0, 0, std::exchange(client.inherited, {}));
}

void LinuxNode::fork(Client& client) {
    std::uint32_t slot = 0;
    while (slot < wire::kMaximumProcesses && entry(slot).state != ProcessEntry::Free)
        ++slot;
    int sockets[2] = {-1, -1};
    // Children whose parents end become this process's own, so that their status can be had.
    const bool adopts = prctl(PR_SET_CHILD_SUBREAPER, 1) == 0;
    if (slot == wire::kMaximumProcesses || !adopts ||
        socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets) != 0) {
        warn(fmt::format("{}: no more processes: at most {} at a time", spec_.program,
                         wire::kMaximumProcesses));
        return finish(client, -1, EAGAIN);
    }
    ProcessEntry& made = entry(slot);
    made.state = ProcessEntry::Alive;
    made.number = ++last_number_;
    made.parent = static_cast<std::int32_t>(client.slot);
    made.group = entry(client.slot).group;
    made.host = 0;
    made.now = client.request.now;
    made.call_name[0] = '\0';
    made.computed = made.children_computed = 0;
    made.faults = 0;
    for (wire::SignalOrigin& origin : made.origins)
        origin = {};
    wire::Channel& channel = *new (wire::channel_of(launcher_->page(), slot)) wire::Channel;
    auto child = std::make_unique<Client>();
    child->slot = slot;
    child->process = std::make_unique<Process>(sockets[0], made, channel);
    child->inherited = client.data;
    child->handles = client.handles;
    for (const int handle : child->handles)
        kernel_.share(handle);
    client.passed = sockets[1];
    clients_.push_back(std::move(child));
    launcher_->page().alive = static_cast<std::uint32_t>(clients_.size());
    ++processes_;
    finish(client, slot);
}

void LinuxNode::hear_child(Client& parent) {
    Client* child = client_at(parent.request.a);
    if (child == nullptr || child->state != Client::State::Starting) return;
    const Time now = parent.request.now;
    if (parent.request.b == 0) {
        client_ended(*child, now);
        entry(parent.request.a).state = ProcessEntry::Free;
        return;
    }
    switch (child->process->hear(kChildPatience, child->request, child->data)) {
    case ProcessEvent::Request:
        child->request.now = now;
        child->state = Client::State::Asking;
        return;
    case ProcessEvent::Silent:
        warn(fmt::format("{}: a child process does not load the preloaded library: it was killed",
                         spec_.program));
        child->process->kill();
        break;
    case ProcessEvent::Ended:
        break;
    }
    client_ended(*child, now);
}

void LinuxNode::send_signal(std::uint32_t slot, int signal, Time now, const wire::SignalOrigin& origin) {
    Client* client = client_at(slot);
    if (client == nullptr || signal <= 0 || signal >= NSIG) return;
    if (signal == SIGKILL) {
        client->process->kill();
        client_ended(*client, now);
        return;
    }
    entry(slot).origins[signal] = origin;
    client->signals |= std::uint64_t{1} << signal;
    client->signals_at = std::min(client->signals_at, now);
}

void LinuxNode::signal_all(int signal, Time now) {
    std::vector<std::uint32_t> slots;
    for (const auto& client : clients_)
        slots.push_back(client->slot);
    for (const std::uint32_t slot : slots)
        send_signal(slot, signal, now);
}

void LinuxNode::changed(const Client* by, Time now) {
    for (const auto& client : clients_)
        if (client.get() != by && client->state == Client::State::Waiting && client->request.watches != 0)
            client->woken_at = std::min(client->woken_at, now);
}

/// A process that is gone closes its files; the last close of the serial port takes until the bytes are out,
/// and until then the others see the process. False if there is nothing to wait for.
bool LinuxNode::leaves_slowly(Client& client, Time now) {
    if (std::exchange(client.leaving, true)) return false;
    client.process->kill();
    kernel_.forget(client.slot, std::max(now, begun_));
    int port = -1;
    for (const int handle : std::exchange(client.handles, {})) {
        const int closed = kernel_.is_serial_port(handle) ? std::exchange(port, handle) : handle;
        if (closed >= 0) kernel_.release(closed, std::max(now, begun_));
    }
    if (port < 0) return false;
    client.finished.clear();
    client.request = {};
    client.request.op = Op::Close;
    client.request.handle = port;
    client.request.thread = thread_of(client.slot, 0);
    client.request.now = std::max(now, begun_);
    client.request.wait_until = kNever;
    client.state = Client::State::Waiting;
    kernel_.call(client.request, {});
    deal_out();
    if (!client.finished.empty()) return false;
    changed(&client, now);
    return true;
}

void LinuxNode::client_ended(Client& client, Time now) {
    // What the program's memory states may be anything.
    now = std::clamp(now, client.answered, std::max(client.answered, until_));
    if (leaves_slowly(client, now)) return;
    const std::uint32_t slot = client.slot;
    const bool signalled = client.end_signalled;
    kernel_.forget(slot, std::max(now, begun_));
    ProcessEntry& ended = entry(slot);
    ended.status = client.process->wait_status();
    ended.state = ProcessEntry::Ended;
    if (slot == 0) {
        end_ = client.process->describe_end();
        ended_well_ = client.process->ended_well();
        crashed_ = client.process->crashed();
        killed_by_ = client.process->killed_by();
    }
    std::erase_if(clients_, [slot](const auto& other) { return other->slot == slot; });
    launcher_->page().alive = static_cast<std::uint32_t>(clients_.size());
    for (std::uint32_t other = 0; other < wire::kMaximumProcesses; ++other) {
        ProcessEntry& orphan = entry(other);
        if (orphan.state == ProcessEntry::Free || orphan.parent != static_cast<std::int32_t>(slot)) continue;
        orphan.parent = wire::kNoParent;
        if (orphan.state == ProcessEntry::Ended) orphan.state = ProcessEntry::Free;
    }
    if (ended.parent == wire::kNoParent) {
        ended.state = ProcessEntry::Free;
    } else {
        send_signal(static_cast<std::uint32_t>(ended.parent), SIGCHLD, now, {ended.number, 1, ended.status});
    }
    if (slot == 0 && !clients_.empty()) first_ended(now);
    changed(nullptr, now);
    if (signalled) signalled_ended(now);
    if (clients_.empty()) program_ended(now);
}

void LinuxNode::kill_all(Time now) {
    for (const auto& client : clients_)
        client->process->kill();
    clients_.clear();
    kernel_.reset(now);
}

}  // namespace puckloop::linuxboard
