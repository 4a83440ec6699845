#include "linuxboard/shim/kernel/board_kernel.h"

#include <linux/i2c.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;
using wire::DeviceKind;
using wire::Op;
using wire::Request;

namespace {
/// VTIME counts tenths of a second.
constexpr Time kVtimeUnit = 100 * cosim::kMillisecond;

constexpr Time kClosingWait = 30 * cosim::kSecond;

constexpr int kInputEvents = POLLIN | POLLRDNORM;

template <typename T>
T read_object(std::string_view& data) {
    T object{};
    std::memcpy(&object, data.data(), std::min(sizeof object, data.size()));
    data.remove_prefix(std::min(sizeof object, data.size()));
    return object;
}

/// The devices that know a call on an open file.
DeviceKind kind_for(Op op) {
    switch (op) {
    case Op::Transfer:
        return DeviceKind::I2c;
    case Op::Ioctl:
    case Op::Map:
    case Op::VideoRead:
        return DeviceKind::Video;
    default:
        return op >= Op::Socket ? DeviceKind::Socket : DeviceKind::Tty;
    }
}

/// Of the messages of one transfer.
std::vector<std::uint16_t> addresses_of(std::uint32_t count, std::string_view data) {
    std::vector<std::uint16_t> addresses;
    for (std::uint32_t i = 0; i < count && !data.empty(); ++i) {
        const auto segment = read_object<wire::I2cSegment>(data);
        addresses.push_back(segment.address);
        if ((segment.flags & I2C_M_RD) == 0)
            data.remove_prefix(std::min<std::size_t>(segment.length, data.size()));
    }
    return addresses;
}

template <typename T>
std::string bytes_of(const T& object) {
    std::string bytes(sizeof object, '\0');
    std::memcpy(bytes.data(), &object, sizeof object);
    return bytes;
}
}  // namespace

BoardKernel::BoardKernel(const LinuxSpec& spec, LinuxFaults& faults)
    : faults_(faults),
      tty_(spec.clock_ppm, spec.fifo_trigger, spec.tty_batch),
      adapter_(std::llround(static_cast<double>(cosim::kSecond) / spec.i2c_hertz), spec.i2c_nack_error,
               spec.i2c_hold),
      has_tty_(!spec.tty.empty()),
      i2c_files_(spec.i2c.size()) {
    if (!spec.network) return;
    network_.emplace(*spec.network, RandomStream(spec.seed, "linux.network." + spec.name));
    if (LinuxFaults::concern_names(spec.faults))
        network_->set_silence(
            [this](Time now, std::string_view name) { return faults_.silences(now, name); });
}

void BoardKernel::finish(std::uint32_t thread, std::int64_t result, int error, Time time, std::string data) {
    FinishedCall call;
    call.header.thread = thread;
    call.header.error = error;
    call.header.result = error != 0 ? -1 : result;
    call.header.time = time;
    call.header.length = static_cast<std::uint32_t>(data.size());
    call.data = std::move(data);
    finished_.push_back(std::move(call));
}

void BoardKernel::open_file(const Request& request) {
    const std::size_t i2c_index = request.a - (has_tty_ ? 1 : 0);
    File file;
    file.open = true;
    if (has_tty_ && request.a == 0) {
        file.kind = DeviceKind::Tty;
        tty_.open();
        tty_opened_ = true;
    } else if (i2c_index < i2c_files_) {
        file.kind = DeviceKind::I2c;
        i2c_opened_ = true;
    } else if (i2c_index - i2c_files_ < cameras_.size()) {
        file.kind = DeviceKind::Video;
        file.camera = i2c_index - i2c_files_;
        camera_opened_ = true;
    } else {
        finish(request.thread, -1, ENODEV, request.now);
        return;
    }
    const int handle = place_file(file);
    if (file.kind == DeviceKind::Video) cameras_[file.camera]->open(handle);
    finish_open(request.thread, handle, request.now);
}

int BoardKernel::place_file(const File& file) {
    std::size_t handle = 0;
    while (handle < files_.size() && files_[handle].open)
        ++handle;
    if (handle == files_.size()) files_.emplace_back();
    files_[handle] = file;
    return static_cast<int>(handle);
}

void BoardKernel::finish_open(std::uint32_t thread, int handle, Time time, std::string data) {
    finish(thread, handle, 0, time, std::move(data));
    finished_.back().opens = true;
}

void BoardKernel::call(const Request& request, std::string_view data) {
    const Time now = request.now;
    switch (request.op) {
    case Op::Open:
        open_file(request);
        return;
    case Op::Socket:
        open_socket(request);
        return;
    case Op::Take:
        take_socket(request, data);
        return;
    case Op::Cancel: {
        waiting_.erase(request.thread);
        begun_.erase(request.thread);
        adapter_.abandon(request.thread);
        return;
    }
    case Op::Poll:
    case Op::Resolve:
        break;
    case Op::Hello:
    case Op::Sync:
    case Op::Note:
    case Op::Exit:
    case Op::Fork:
    case Op::Forked:
    case Op::Exec:
    case Op::Changed:
    case Op::Kill:
    case Op::Reap:
        return;
    default: {
        const auto handle = static_cast<std::size_t>(request.handle);
        if (request.handle < 0 || handle >= files_.size() || !files_[handle].open) {
            finish(request.thread, -1, EBADF, now);
            return;
        }
        const File& file = files_[handle];
        if (request.op != Op::Close && kind_for(request.op) != file.kind) {
            finish(request.thread, -1, ENOTTY, now);
            return;
        }
    }
    }
    Waiting waiting{request, std::string(data), {}, 0, now};
    if (request.op == Op::Send && !join_pieces(request, waiting.data)) return;
    if (!faults_.empty() && suffers(waiting, now)) return;
    if (request.op == Op::Resolve) {
        const LinuxFaults::Resolution resolution = faults_.resolve(now, data);
        waiting.request.deadline = resolution.until;
        waiting.progress = resolution.failed ? 1 : 0;
    }
    if (request.op == Op::Transfer) {
        submit_transfer(request, data);
        Waiting transfer{request, {}, {}, 0, now};
        waiting_.emplace(request.thread, std::move(transfer));
        return;
    }
    if (!attempt(request.thread, waiting, now)) {
        waiting_.insert_or_assign(request.thread, std::move(waiting));
    } else if (request.op == Op::Ioctl || request.op == Op::Close || request.op == Op::Insert ||
               is_socket_call(request.op)) {
        attempt_all(now);  // a stream's end ends the calls that wait for its frames
    }
}

bool BoardKernel::attempt(std::uint32_t thread, Waiting& waiting, Time now) {
    const Request& request = waiting.request;
    const auto done = [&](std::int64_t result, int error = 0, std::string data = {}) {
        finish(thread, result, error, now, std::move(data));
        return true;
    };
    if (is_socket_call(request.op)) return attempt_socket(thread, waiting, now);
    switch (request.op) {
    case Op::Close:
        if (drains_first(waiting, now)) return false;
        release(request.handle, now);
        return done(0);
    case Op::Read:
        return attempt_read(thread, waiting, now);
    case Op::Write:
        return attempt_write(thread, waiting, now);
    case Op::Poll:
        return attempt_poll(thread, waiting, now);
    case Op::GetTermios:
        return done(0, 0, bytes_of(tty_.settings()));
    case Op::SetTermios: {
        if (request.a != TCSANOW && !tty_.drained(now)) return false;
        std::string_view data = waiting.data;
        if (request.a == TCSAFLUSH) tty_.flush_input();
        const auto wanted = read_object<termios>(data);
        tty_.configure(faults_.empty() ? wanted : faults_.configure(now, tty_.settings(), wanted));
        tty_.distort_rate(faults_.rate_factor());
        return done(0);
    }
    case Op::Flush:
        if (request.a != TCOFLUSH) tty_.flush_input();
        if (request.a != TCIFLUSH) tty_.flush_output();
        return done(0);
    case Op::Flow:
        if (request.a == TCOOFF) tty_.stop_output();
        if (request.a == TCOON) tty_.start_output(now);
        return done(0);
    case Op::Drain:
        return tty_.drained(now) || tty_.hung_up() ? done(0) : false;
    case Op::Break:
        // As the tty layer: what was written goes out, then the break lasts as long as the call.
        if (waiting.progress == 0) {
            if (!tty_.drained(now) && !tty_.hung_up()) return false;
            tty_.send_break(now, request.b * cosim::kMicrosecond);
            waiting.progress = 1;
            waiting.since = now;
        }
        return now >= waiting.since + request.b * cosim::kMicrosecond ? done(0) : false;
    case Op::Resolve:
        return now >= request.deadline ? done(0, waiting.progress != 0 ? EAGAIN : 0) : false;
    case Op::Insert:
        tty_.insert(static_cast<char>(request.a), now);
        return done(0);
    case Op::InputQueue:
        return done(static_cast<std::int64_t>(tty_.input_queue()));
    case Op::OutputQueue:
        return done(static_cast<std::int64_t>(tty_.output_queue(now)));
    case Op::Counters:
        return done(0, 0, bytes_of(tty_.counters()));
    case Op::Transfer:
        return false;  // ends when the adapter ends it
    case Op::Ioctl:
    case Op::Map:
    case Op::VideoRead:
        return attempt_video(thread, waiting, now);
    default:
        return done(-1, ENOSYS);
    }
}

/// The serial core's: the last close of a port waits for what was written, and gives it up after this time.
/// Output that is stopped it gives up at once (deviation: Linux does after an ioctl, and waits after XOFF).
bool BoardKernel::drains_first(const Waiting& waiting, Time now) const {
    const File& file = files_[static_cast<std::size_t>(waiting.request.handle)];
    return file.kind == DeviceKind::Tty && file.references == 1 && tty_.is_open_once() && !tty_.hung_up() &&
           tty_.sends() && !tty_.drained(now) && now < waiting.since + kClosingWait;
}

bool BoardKernel::attempt_read(std::uint32_t thread, Waiting& waiting, Time now) {
    const std::size_t most = waiting.request.a;
    const auto done = [&](int error = 0) {
        const auto count = static_cast<std::int64_t>(waiting.gathered.size());
        finish(thread, count, error, now, std::move(waiting.gathered));
        return true;
    };
    if (tty_.hung_up() || most == 0) return done();
    const termios& settings = tty_.settings();
    if (tty_.canonical()) {
        if (tty_.input_ready()) {
            waiting.gathered = tty_.read(most);
            return done();
        }
        return waiting.request.nonblocking != 0 ? done(EAGAIN) : false;
    }
    const std::size_t before = waiting.gathered.size();
    waiting.gathered += tty_.read(most - before);
    const std::size_t minimum = settings.c_cc[VMIN];
    const Time pause = settings.c_cc[VTIME] * kVtimeUnit;
    if (waiting.request.nonblocking != 0) {
        if (!waiting.gathered.empty()) return done();
        return done(minimum == 0 && pause == 0 ? 0 : EAGAIN);
    }
    if (waiting.gathered.size() > before) waiting.since = now;
    if (!waiting.gathered.empty() &&
        waiting.gathered.size() >= std::min(std::max<std::size_t>(minimum, 1), most))
        return done();
    if (minimum == 0 && now >= waiting.since + pause) return done();
    if (minimum > 0 && pause > 0 && !waiting.gathered.empty() && now >= waiting.since + pause) return done();
    return false;
}

bool BoardKernel::attempt_write(std::uint32_t thread, Waiting& waiting, Time now) {
    if (tty_.hung_up()) {
        finish(thread, -1, EIO, now);
        return true;
    }
    const std::string_view rest = std::string_view(waiting.data).substr(waiting.progress);
    waiting.progress += tty_.write(rest, now);
    const bool complete = waiting.progress == waiting.data.size();
    if (!complete && waiting.request.nonblocking == 0) return false;
    const bool none = waiting.progress == 0 && !complete;
    finish(thread, static_cast<std::int64_t>(waiting.progress), none ? EAGAIN : 0, now);
    return true;
}

std::int16_t BoardKernel::tty_events() const {
    int events = 0;
    if (tty_.hung_up()) return POLLIN | POLLRDNORM | POLLOUT | POLLWRNORM | POLLHUP | POLLERR;
    if (tty_.input_ready()) events |= POLLIN | POLLRDNORM;
    // The tty layer reports room from 256 free bytes on; half a buffer is never far from that.
    if (tty_.output_room() >= 256) events |= POLLOUT | POLLWRNORM;
    return static_cast<std::int16_t>(events);
}

/// Edge-triggered, there is something new when a byte came in or went out.
std::int16_t BoardKernel::tty_news(wire::PollEntry& entry) const {
    if (entry.seen == 0) return tty_events();
    const wire::TtyCounters counters = tty_.counters();
    const std::uint32_t activity = 1 + (counters.received + counters.sent) % (wire::kNeverSeen - 1);
    const bool news = std::exchange(entry.seen, activity) != activity;
    return news || tty_.hung_up() ? tty_events() : std::int16_t{0};
}

std::int16_t BoardKernel::events_of(wire::PollEntry& entry, Time now) {
    const auto handle = static_cast<std::size_t>(entry.handle);
    if (entry.handle < 0 || handle >= files_.size() || !files_[handle].open) return POLLNVAL;
    int events = POLLIN | POLLRDNORM | POLLOUT | POLLWRNORM;  // i2c-dev has no poll method
    if (files_[handle].kind == DeviceKind::Tty) events = tty_news(entry);
    if (files_[handle].kind == DeviceKind::Video)
        events = camera_of(entry.handle).events(entry.handle, (entry.events & kInputEvents) != 0, now);
    if (files_[handle].kind == DeviceKind::Socket) events = socket_events(entry);
    return static_cast<std::int16_t>(events & (entry.events | POLLHUP | POLLERR));
}

bool BoardKernel::attempt_poll(std::uint32_t thread, Waiting& waiting, Time now) {
    std::string answer;
    std::int64_t ready = 0;
    for (std::string_view data = waiting.data; !data.empty();) {
        auto entry = read_object<wire::PollEntry>(data);
        entry.returned = events_of(entry, now);
        ready += entry.returned != 0 ? 1 : 0;
        answer += bytes_of(entry);
    }
    if (ready == 0 && now < waiting.request.deadline) return false;
    finish(thread, ready, 0, now, std::move(answer));
    return true;
}

void BoardKernel::submit_transfer(const Request& request, std::string_view data) {
    I2cTransfer transfer;
    transfer.owner = request.thread;
    transfer.timeout = request.a * cosim::kMillisecond;
    for (std::uint32_t i = 0; i < request.b && !data.empty(); ++i) {
        const auto segment = read_object<wire::I2cSegment>(data);
        I2cMessage message;
        message.address = segment.address;
        message.ten_bits = (segment.flags & I2C_M_TEN) != 0;
        message.read = (segment.flags & I2C_M_RD) != 0;
        message.counted = (segment.flags & I2C_M_RECV_LEN) != 0;
        message.length = segment.length;
        if (!message.read) {
            message.data = data.substr(0, segment.length);
            data.remove_prefix(std::min<std::size_t>(segment.length, data.size()));
        }
        transfer.messages.push_back(std::move(message));
    }
    adapter_.submit(std::move(transfer), request.now);
}

bool BoardKernel::suffers(Waiting& waiting, Time now) {
    wire::Request& request = waiting.request;
    int error = 0;
    if (request.op == Op::Read) {
        const CallDamage damage = faults_.read(now, request.a);
        request.a = static_cast<std::uint32_t>(std::min<std::size_t>(request.a, damage.most));
        error = damage.error;
    } else if (request.op == Op::Write) {
        const CallDamage damage = faults_.write(now, waiting.data.size());
        waiting.data.resize(std::min(waiting.data.size(), damage.most));
        error = damage.error;
    } else if (request.op == Op::Transfer) {
        error = faults_.transfer(now, addresses_of(request.b, waiting.data));
    }
    if (error != 0) finish(request.thread, -1, error, now);
    return error != 0;
}

Time BoardKernel::wake_time(const Waiting& waiting) const {
    if (is_socket_call(waiting.request.op)) return socket_wake_time(waiting);
    switch (waiting.request.op) {
    case Op::Poll:
    case Op::Resolve:
        return waiting.request.deadline;
    case Op::Read: {
        const termios& settings = tty_.settings();
        if (tty_.canonical() || settings.c_cc[VTIME] == 0) return kNever;
        if (settings.c_cc[VMIN] > 0 && waiting.gathered.empty()) return kNever;
        return waiting.since + settings.c_cc[VTIME] * kVtimeUnit;
    }
    case Op::Break:
        if (waiting.progress == 0) return tty_.drain_time();
        return waiting.since + waiting.request.b * cosim::kMicrosecond;
    case Op::SetTermios:
    case Op::Drain:
        return tty_.drain_time();
    case Op::Close:
        return std::min(tty_.drain_time(), waiting.since + kClosingWait);
    default:
        return kNever;
    }
}

Time BoardKernel::next_event() const {
    Time next = std::min({tty_.next_event(), adapter_.next_event(), next_frame(), next_network()});
    if (resumes_ < kNever) return std::min(next, resumes_);
    for (const auto& [thread, waiting] : waiting_)
        next = std::min(next, wake_time(waiting));
    return next;
}

Time BoardKernel::next_completion(Time message) const {
    Time next = waiting_.empty() ? kNever : message;
    for (const auto& [thread, waiting] : waiting_)
        next = std::min(next, device_completion(waiting, adapter_.next_event()));
    return next;
}

Time BoardKernel::next_wake(std::span<const cosim::Message> next) const {
    Time wake = kNever;
    for (const auto& [thread, waiting] : waiting_)
        wake = std::min(wake, device_completion(waiting, adapter_.next_completion()));
    if (waiting_.empty()) return wake;
    for (const cosim::Message& message : next) {
        const auto* frame = std::get_if<cosim::UartFrame>(&message.payload);
        const auto* phase = std::get_if<cosim::I2cPhase>(&message.payload);
        if (frame != nullptr ? tty_.fills(*frame) : phase != nullptr && adapter_.ends_with(*phase))
            wake = std::min(wake, message.time);
    }
    return wake;
}

Time BoardKernel::device_completion(const Waiting& waiting, Time transfers_end) const {
    const Time next = wake_time(waiting);
    if (is_socket_call(waiting.request.op)) return std::min(next, next_network());
    switch (waiting.request.op) {
    case Op::Read:
        return std::min(next, tty_.next_input());
    case Op::Resolve:
        return next;
    case Op::Transfer:
        return std::min(next, transfers_end);
    case Op::Ioctl:
    case Op::VideoRead:
        return std::min(next, next_frame());
    default:  // what goes out may end it as well
        return std::min({next, asks_for_input_only(waiting) ? tty_.next_input() : tty_.next_event(),
                         next_frame(), next_network()});
    }
}

bool BoardKernel::asks_for_input_only(const Waiting& waiting) {
    if (waiting.request.op != Op::Poll) return false;
    for (std::string_view data = waiting.data; !data.empty();)
        if ((read_object<wire::PollEntry>(data).events & (POLLOUT | POLLWRNORM)) != 0) return false;
    return true;
}

std::optional<Time> BoardKernel::waits_for_bytes_since() const {
    std::optional<Time> first;
    for (const auto& [thread, waiting] : waiting_) {
        if (waiting.request.deadline != kNever) continue;
        const auto is_port = [&](int handle) { return handle >= 0 && is_serial_port(handle); };
        bool bytes_only = waiting.request.op == Op::Read && is_port(waiting.request.handle);
        if (asks_for_input_only(waiting)) {
            bytes_only = !waiting.data.empty();
            for (std::string_view data = waiting.data; !data.empty();)
                bytes_only = is_port(read_object<wire::PollEntry>(data).handle) && bytes_only;
        }
        if (bytes_only && (!first || waiting.since < *first)) first = waiting.since;
    }
    return first;
}

void BoardKernel::attempt_all(Time now) {
    if (now < resumes_ && resumes_ < kNever) return;
    resumes_ = kNever;
    for (auto it = waiting_.begin(); it != waiting_.end();) {
        it = attempt(it->first, it->second, now) ? waiting_.erase(it) : std::next(it);
    }
}

void BoardKernel::advance(Time now) {
    tty_.advance(now, frames_);
    adapter_.advance(now, phases_);
    for (const auto& camera : cameras_)
        camera->advance(now);
    if (network_) network_->advance(now);
    for (I2cResult& result : adapter_.take_results()) {
        if (waiting_.erase(result.owner) == 0) continue;
        finish(result.owner, result.messages, result.error, result.time, std::move(result.data));
    }
    attempt_all(now);
}

void BoardKernel::deliver_uart(const cosim::UartFrame& frame, Time now) {
    tty_.deliver(frame, now);
}

void BoardKernel::deliver_i2c(const cosim::I2cPhase& phase, Time now) {
    adapter_.deliver(phase, now);
}

void BoardKernel::hang_up(Time now) {
    tty_.hang_up();
    attempt_all(now);
}

void BoardKernel::forget(std::uint32_t slot, Time now) {
    for (auto it = waiting_.begin(); it != waiting_.end();) {
        if (slot_of(it->first) != slot) {
            ++it;
            continue;
        }
        adapter_.abandon(it->first);
        if (it->second.request.op == Op::Close) release(it->second.request.handle, now);
        it = waiting_.erase(it);
    }
    for (auto* pieces : {&begun_, &rest_})
        std::erase_if(*pieces, [slot](const auto& one) { return slot_of(one.first) == slot; });
    std::erase_if(finished_,
                  [slot](const FinishedCall& call) { return slot_of(call.header.thread) == slot; });
}

bool BoardKernel::is_serial_port(int handle) const {
    return files_[static_cast<std::size_t>(handle)].kind == DeviceKind::Tty;
}

void BoardKernel::share(int handle) {
    ++files_[static_cast<std::size_t>(handle)].references;
}

void BoardKernel::release(int handle, Time now) {
    File& file = files_[static_cast<std::size_t>(handle)];
    if (!file.open || --file.references > 0) return;
    if (file.kind == DeviceKind::Tty) tty_.close();
    if (file.kind == DeviceKind::Video) camera_of(handle).close(handle);
    if (file.kind == DeviceKind::Socket) {
        // Deviation: a thread that still waits on it is not left to wait for ever.
        for (auto it = waiting_.begin(); it != waiting_.end();) {
            if (!is_socket_call(it->second.request.op) || it->second.request.handle != handle) {
                ++it;
                continue;
            }
            finish(it->first, -1, EBADF, now);
            it = waiting_.erase(it);
        }
        network_->close(file.socket, now);
    }
    file.open = false;
}

void BoardKernel::reset(Time now) {
    for (std::size_t handle = 0; handle < files_.size(); ++handle) {
        const File& file = files_[handle];
        if (file.open && file.kind == DeviceKind::Tty) tty_.close();
        if (file.open && file.kind == DeviceKind::Video)
            cameras_[file.camera]->close(static_cast<int>(handle));
    }
    files_.clear();
    if (network_) network_->close_all(now);
    for (const auto& [thread, waiting] : waiting_)
        adapter_.abandon(thread);
    waiting_.clear();
    passed_.clear();
    begun_.clear();
    rest_.clear();
    finished_.clear();
    resumes_ = kNever;
}

std::vector<FinishedCall> BoardKernel::take_finished() {
    return std::exchange(finished_, {});
}
std::vector<cosim::UartFrame> BoardKernel::take_frames() {
    return std::exchange(frames_, {});
}
std::vector<cosim::I2cPhase> BoardKernel::take_phases() {
    return std::exchange(phases_, {});
}

}  // namespace puckloop::linuxboard
