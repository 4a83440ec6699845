#include "toy_nodes.h"

#include "cosim/core/bounded_rewindable.h"

#include "base/error.h"
#include "base/random.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <map>
#include <queue>
#include <sstream>

#include <unistd.h>

namespace puckloop::cosim::toy {

namespace {

constexpr Time kBit = kSecond / 115200;

struct Settings {
    explicit Settings(const std::string& line) {
        std::istringstream words(line);
        words >> kind;
        for (std::string word; words >> word;) {
            const std::size_t equals = word.find('=');
            values[word.substr(0, equals)] = std::stoll(word.substr(equals + 1));
        }
    }
    long long get(const std::string& key, long long otherwise) const {
        const auto found = values.find(key);
        return found == values.end() ? otherwise : found->second;
    }
    std::string kind;
    std::map<std::string, long long> values;
};

/// Ports uart0.. then signals0.., which are I2C ports by their kind with bus=1; an event queue; what came in
/// is folded into a digest.
class ToyNode : public Node {
  public:
    explicit ToyNode(const Settings& settings) : settings_(settings), name_(settings.kind) {
        for (int i = 0; i < settings.get("uarts", 1); ++i)
            ports_.push_back({"uart" + std::to_string(i), PortKind::Uart});
        for (int i = 0; i < settings.get("signals", 0); ++i)
            ports_.push_back({"signals" + std::to_string(i),
                              settings.get("bus", 0) != 0 ? PortKind::I2c : PortKind::Signals});
    }

    std::string_view name() const override { return name_; }
    std::span<const Port> ports() const override { return ports_; }
    Time earliest_output(PortIndex) const override { return kNever; }
    Time lookahead(PortIndex) const override { return kNever; }
    std::string finish() override {
        return "{\"digest\": " + std::to_string(digest_) + ", \"messages\": " + std::to_string(received_) +
               "}";
    }

    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        std::size_t next = 0;
        while (true) {
            const Time message = next < inbox.size() ? inbox[next].time : kNever;
            const Time event = next_event();
            if (message <= event && message != kNever) {
                fold(inbox[next]);
                receive(inbox[next], outbox);
                ++next;
            } else if (event < until) {
                handle(event, outbox);
            } else {
                break;
            }
        }
        reached_ = until;
    }

  protected:
    virtual Time next_event() const { return kNever; }
    virtual void handle(Time, std::vector<Message>&) {}
    virtual void receive(const Message&, std::vector<Message>&) {}

    void fold(const Message& message) {
        ++received_;
        const auto mix = [this](std::uint64_t value) { digest_ = (digest_ ^ value) * 0x100000001b3u; };
        mix(static_cast<std::uint64_t>(message.time));
        mix(message.port);
        if (const auto* frame = std::get_if<UartFrame>(&message.payload)) mix(frame->data);
        if (const auto* signal = std::get_if<Signal>(&message.payload)) mix(signal->id);
    }

    Settings settings_;
    std::string name_;
    std::vector<Port> ports_;
    Time reached_ = 0;
    std::uint64_t digest_ = 0xcbf29ce484222325u;
    std::uint64_t received_ = 0;
};

class Chatter : public ToyNode {
  public:
    explicit Chatter(const Settings& settings)
        : ToyNode(settings),
          random_(static_cast<std::uint64_t>(settings.get("seed", 1)), "chatter"),
          answers_(static_cast<std::uint64_t>(settings.get("seed", 1)), "answers"),
          think_(settings.get("think_us", 3) * kMicrosecond),
          fly_(settings.get("fly_us", 2) * kMicrosecond),
          gap_(settings.get("gap_us", 150) * kMicrosecond),
          early_(settings.get("early", 0) != 0),
          lines_(ports_.size()) {
        push({draw_gap(), Kind::Act, 0});
    }

    Time earliest_output(PortIndex port) const override {
        if (lines_[port].begun) return *lines_[port].begun + 9 * kBit;
        const Time next = next_event();
        return ports_[port].kind == PortKind::Uart ? next : later(next, fly_);
    }
    Time lookahead(PortIndex port) const override {
        return ports_[port].kind == PortKind::Uart ? think_ : think_ + fly_;
    }
    std::optional<Time> begun(PortIndex port) const override { return lines_[port].begun; }

  protected:
    enum class Kind { Act, StopBit };
    struct Event {
        Time time;
        Kind kind;
        PortIndex port;
        std::uint64_t sequence = 0;
        bool operator<(const Event& other) const {
            return std::tie(other.time, other.sequence) < std::tie(time, sequence);
        }
    };
    struct Line {
        std::optional<Time> begun;  ///< frame to be handed out at its stop bit
        Time free_at = 0;
        std::uint16_t data = 0;
    };

    Time next_event() const override { return events_.empty() ? kNever : events_.top().time; }

    void handle(Time now, std::vector<Message>& outbox) override {
        const Event event = events_.top();
        events_.pop();
        if (event.kind == Kind::StopBit) {
            Line& line = lines_[event.port];
            outbox.push_back({now, event.port, frame(*line.begun, line.data)});
            line.begun.reset();
            return;
        }
        push({now + draw_gap(), Kind::Act, 0});
        say(now, outbox);
    }

    void receive(const Message& message, std::vector<Message>&) override {
        // An answer adds an act, and every act the next one: keep the population bounded.
        if (answers_.below(10) < 3 && events_.size() < 12) push({message.time + think_, Kind::Act, 0});
    }

  private:
    void say(Time now, std::vector<Message>& outbox) {
        const auto port = static_cast<PortIndex>(random_.below(ports_.size()));
        if (ports_[port].kind != PortKind::Uart) {
            outbox.push_back(
                {now + fly_, port, Signal{static_cast<std::uint16_t>(random_.below(4)), random_.uniform()}});
            return;
        }
        Line& line = lines_[port];
        if (now < line.free_at) return;
        line.free_at = now + 10 * kBit;
        line.data = static_cast<std::uint16_t>(random_.below(256));
        if (early_) {
            outbox.push_back({now + 9 * kBit, port, frame(now, line.data)});
        } else {
            line.begun = now;
            push({now + 9 * kBit, Kind::StopBit, port});
        }
    }

    static UartFrame frame(Time start, std::uint16_t data) {
        UartFrame frame;
        frame.start = start;
        frame.bit_period = kBit;
        frame.data = data;
        return frame;
    }
    Time draw_gap() { return 1 + static_cast<Time>(random_.below(static_cast<std::uint64_t>(2 * gap_))); }
    void push(Event event) {
        event.sequence = sequence_++;
        events_.push(event);
    }

    RandomStream random_;
    RandomStream answers_;  ///< apart, so that what comes in changes nothing before it was thought about
    Time think_, fly_, gap_;
    bool early_;
    std::vector<Line> lines_;
    std::priority_queue<Event> events_;
    std::uint64_t sequence_ = 0;
};

/// Waits for ever for a frame, answers with the next byte.
class Echo : public ToyNode {
  public:
    explicit Echo(const Settings& settings)
        : ToyNode(settings), delay_(settings.get("delay_us", 10) * kMicrosecond) {
        if (settings.get("first", 0) != 0) first_ = kMicrosecond;
    }
    Time earliest_output(PortIndex) const override { return first_; }
    Time lookahead(PortIndex) const override { return delay_ + 9 * kBit; }

  protected:
    Time next_event() const override { return first_; }
    void handle(Time now, std::vector<Message>& outbox) override {
        first_ = kNever;
        send(now, 0, outbox);
    }
    void receive(const Message& message, std::vector<Message>& outbox) override {
        const auto& frame = std::get<UartFrame>(message.payload);
        send(message.time + delay_, static_cast<std::uint16_t>((frame.data + 1) & 0xff), outbox);
    }

  private:
    static void send(Time start, std::uint16_t data, std::vector<Message>& outbox) {
        UartFrame frame;
        frame.start = start;
        frame.bit_period = kBit;
        frame.data = data;
        outbox.push_back({start + 9 * kBit, 0, frame});
    }
    Time delay_;
    Time first_ = kNever;
};

/// Everything that goes wrong, or ends, at one time.
class AtTime : public ToyNode {
  public:
    explicit AtTime(const Settings& settings)
        : ToyNode(settings), at_(settings.get("at_us", 1000) * kMicrosecond) {}
    std::optional<Stop> stop() const override {
        if (!done_ || name_ != "stopper") return std::nullopt;
        return Stop{at_, settings_.get("success", 1) != 0, "asked to",
                    static_cast<std::uint32_t>(settings_.get("together", 1))};
    }

  protected:
    Time next_event() const override { return done_ ? kNever : at_; }
    void handle(Time now, std::vector<Message>& outbox) override {
        done_ = true;
        if (name_ == "thrower") throw RunError("thrown on purpose");
        if (name_ == "exiter") std::_Exit(3);
        if (name_ == "aborter") std::raise(SIGABRT);
        while (name_ == "staller")
            pause();
        if (name_ == "liar") outbox.push_back({now, 0, UartFrame{now - 9 * kBit, kBit, 0x55}});
    }

  private:
    Time at_;
    bool done_ = false;
};

class Turncoat : public ToyNode {
  public:
    explicit Turncoat(const Settings& settings)
        : ToyNode(settings), at_(settings.get("at_us", 1000) * kMicrosecond) {}
    Time earliest_output(PortIndex) const override { return reached_ > at_ ? reached_ : kNever; }

  protected:
    Time next_event() const override { return spoke_ ? kNever : at_ + 20 * kMillisecond; }
    void handle(Time now, std::vector<Message>& outbox) override {
        spoke_ = true;
        outbox.push_back({now + 9 * kBit, 0, UartFrame{now, kBit, 0x55}});
    }

  private:
    Time at_;
    bool spoke_ = false;
};

class Mutual : public ToyNode {
  public:
    using ToyNode::ToyNode;
    Time earliest_output(PortIndex) const override { return reached_; }
    Time lookahead(PortIndex) const override { return 0; }
};

/// One that can go back, by a copy of all of it.
template <class Toy>
class GoesBack final : public Toy, public Rewindable {
  public:
    using Toy::Toy;
    Rewindable* rewindable() override { return this; }
    void mark() override { marked_ = std::make_unique<Toy>(*this); }
    void rewind() override {
        if (!marked_) throw RunError("was never marked");
        static_cast<Toy&>(*this) = *marked_;
    }
    void settle() override { marked_.reset(); }

  private:
    std::unique_ptr<Toy> marked_;
};

/// The same, but each 150 us, and where something comes in in certain microseconds, it does what it cannot
/// take back. One that is made to do so before that is sure ends the program.
template <class Toy>
class GoesBackSometimes final : public Toy, public BoundedRewindable {
  public:
    using Toy::Toy;
    Rewindable* rewindable() override { return this; }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        if (marked_)
            for (const Message& message : inbox)
                if (until > horizon({&message, 1})) std::abort();
        if (marked_ && until > horizon({})) std::abort();
        Toy::advance(until, inbox, outbox);
        at_ = until;
    }
    void mark() override {
        marked_ = std::make_unique<Toy>(*this);
        marked_at_ = at_;
    }
    void rewind() override {
        static_cast<Toy&>(*this) = *marked_;
        at_ = marked_at_;
    }
    void settle() override { marked_.reset(); }
    Time horizon(std::span<const Message> next) const override {
        constexpr Time kAct = 150 * kMicrosecond;
        const Time acts = (at_ + kAct - 1) / kAct * kAct;
        const bool stirs = !next.empty() && next.front().time / kMicrosecond % 3 == 0;
        return stirs ? std::min(acts, std::max(at_, next.front().time)) : acts;
    }

  private:
    std::unique_ptr<Toy> marked_;
    Time at_ = 0, marked_at_ = 0;
};

template <class Toy>
std::unique_ptr<Node> make_ahead(const Settings& settings) {
    if (settings.get("bounded", 0) != 0) return std::make_unique<GoesBackSometimes<Toy>>(settings);
    return std::make_unique<GoesBack<Toy>>(settings);
}

std::unique_ptr<Node> make_that_goes_back(const Settings& settings) {
    if (settings.kind == "chatter") return make_ahead<Chatter>(settings);
    if (settings.kind == "echo") return make_ahead<Echo>(settings);
    if (settings.kind == "idle") return make_ahead<ToyNode>(settings);
    return make_ahead<AtTime>(settings);
}

}  // namespace

std::unique_ptr<Node> make(const std::string& line) {
    const Settings settings(line);
    if (settings.get("ahead", 0) != 0) return make_that_goes_back(settings);
    if (settings.kind == "chatter") return std::make_unique<Chatter>(settings);
    if (settings.kind == "echo") return std::make_unique<Echo>(settings);
    if (settings.kind == "idle") return std::make_unique<ToyNode>(settings);
    if (settings.kind == "turncoat") return std::make_unique<Turncoat>(settings);
    if (settings.kind == "mutual") return std::make_unique<Mutual>(settings);
    if (settings.kind == "refuser") throw InputError("toy.hex", "line 7", "damaged on purpose");
    return std::make_unique<AtTime>(settings);
}

}  // namespace puckloop::cosim::toy
