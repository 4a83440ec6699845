// Whose turn it is: the node answers a process of the program, which then runs on its own until its next
// request. One at a time does; meanwhile advance() can be left (Suspendable), so that the program runs beside
// other nodes.

#include "linuxboard/shim/node/linux_node.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <utility>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Message;
using cosim::Time;
using wire::Op;

namespace {
/// Requests between two looks at how long the log has become.
constexpr std::uint64_t kLooksAtLog = 64;
}  // namespace

void LinuxNode::advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
    for (bool done = begin(until, inbox, outbox); !done;)
        done = resume(true);
}

bool LinuxNode::begin(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
    action_.reset();
    inbox_.erase(inbox_.begin(), inbox_.begin() + static_cast<std::ptrdiff_t>(inbox_next_));
    inbox_next_ = 0;
    inbox_.insert(inbox_.end(), inbox.begin(), inbox.end());
    look_at_first(until_);
    begun_ = std::exchange(until_, until);
    waking_at_.reset();
    outbox_ = &outbox;
    return resume(false);
}

bool LinuxNode::resume(bool wait) {
    action_.reset();
    while (true) {
        if (Client* const running = first(Client::State::Running)) {
            if (!listen(*running, wait)) return false;
            wait = false;
        } else if (waking_at_) {
            if (!wake_ready(*waking_at_)) waking_at_.reset();
        } else if (!step()) {
            break;
        }
    }
    run_devices(until_ - 1);
    outbox_ = nullptr;
    return true;
}

/// What happens next, which may let one process run; false if nothing does before the time granted.
bool LinuxNode::step() {
    const Time scheduled = next_scheduled();
    Client* const asking = first(Client::State::Asking);
    Client* const waiting = first(Client::State::Waiting);
    Time next = scheduled;
    if (asking != nullptr) next = std::min(next, goes_on(*asking));
    // A process that asks takes in what happened at the devices when it is handled.
    if (asking == nullptr || waiting != nullptr) next = std::min(next, next_device_event());
    if (waiting != nullptr) next = std::min(next, goes_on(*waiting));
    if (next >= until_) return false;
    pace(next);
    if (scheduled <= next) {
        run_devices(next);
        run_scheduled(next);
    } else if (asking != nullptr && goes_on(*asking) <= next) {
        handle_request(*asking);
    } else {
        run_devices(next);
    }
    waking_at_ = next;
    return true;
}

void LinuxNode::handle_request(Client& client) {
    must_be_final();
    client.request.now = std::max(client.request.now, paused_until_);
    const Time now = client.request.now;
    run_devices(now);
    switch (client.request.op) {
    case Op::Note:
        warn(client.data);
        break;
    case Op::Exit:
        client.announced_exit = true;
        client.exit_time = now;
        client.state = Client::State::Running;
        return;
    default:
        if (handle_family(client)) break;
        if (client.request.op == Op::Close) client.handles.erase(client.request.handle);
        client.request.thread = thread_of(client.slot, client.request.thread);
        kernel_.call(client.request, client.data);
        break;
    }
    deal_out();
    const bool happened = !client.finished.empty() || client.signals_at <= now;
    if (client.request.wait != 0 && !happened && client.request.wait_until > now) {
        client.state = Client::State::Waiting;
        return;
    }
    answer(client, now);
}

void LinuxNode::answer(Client& client, Time now) {
    must_be_final();
    wire::Reply reply;
    reply.now = now;
    show_ahead(client, reply);
    if (client.signals_at <= now) {
        reply.signals = std::exchange(client.signals, 0);
        client.signals_at = kNever;
    }
    if (client.woken_at <= now) {
        reply.changed = 1;
        client.woken_at = kNever;
    }
    std::vector<FinishedCall> calls = std::exchange(client.finished, {});
    for (FinishedCall& call : calls)
        call.header.time = std::max(call.header.time, std::min(now, paused_until_));
    reply.count = static_cast<std::uint32_t>(calls.size());
    client.answered = now;
    client.process->reply(reply, calls, client.passed);
    if (client.passed >= 0) close(std::exchange(client.passed, -1));
    client.state = Client::State::Running;
}

/// What the program asks for next; false if it has not asked yet.
bool LinuxNode::listen(Client& client, bool wait) {
    const auto heard = client.process->try_hear(spec_.watchdog_s, wait, client.request, client.data);
    if (!heard || requests_ % kLooksAtLog == 0) launcher_->log().release();
    if (!heard) return false;
    launcher_->echo_output();
    catch_up(client);
    switch (*heard) {
    case ProcessEvent::Request:
        ++requests_;
        // A program that has just taken another one's place does not know the time.
        if (client.request.op == Op::Hello) client.request.now = client.answered;
        // A program that writes where it should not may ask for anything, but not for the past.
        client.request.now = std::max(client.request.now, client.answered);
        client.state = Client::State::Asking;
        break;
    case ProcessEvent::Ended:
        client_ended(client, client.announced_exit ? client.exit_time : entry(client.slot).now.load());
        break;
    case ProcessEvent::Silent: {
        const Time now = entry(client.slot).now.load();
        const std::string reason =
            fmt::format("{} has not let time pass for {:g} s of wall clock (half of --stall): {}",
                        spec_.program, spec_.watchdog_s, client.process->describe_silence());
        kill_all(now);
        end_ = "hung";
        end_run(now, false, reason, 1);
        break;
    }
    }
    return true;
}

}  // namespace puckloop::linuxboard
