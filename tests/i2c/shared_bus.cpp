#include "shared_bus.h"

#include "emu/dspic/devices/device.h"
#include "emu/pic/pic_node.h"
#include "emu/rab_board/rab_node.h"
#include "tests/kit/node_under_test.h"

#include <catch2/catch.hpp>
#include <cerrno>

namespace puckloop::tests {

using namespace cosim;
using linuxboard::I2cAdapter;
using linuxboard::I2cResult;
using linuxboard::I2cTransfer;

namespace {

constexpr Time kPicPeriod = 11'140'000;  // 89.8 kHz

/// An adapter that is given its transfers by a list.
class Master final : public Node {
  public:
    Master(std::string name, Time period, std::vector<Task> tasks, std::vector<I2cResult>& results)
        : name_(std::move(name)), adapter_(period, EREMOTEIO), tasks_(std::move(tasks)), results_(results) {}

    std::string_view name() const override { return name_; }
    std::span<const Port> ports() const override { return ports_; }
    void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        for (const Message& message : inbox) {
            run_until(message.time, outbox);
            adapter_.deliver(std::get<I2cPhase>(message.payload), message.time);
        }
        run_until(until, outbox);
        granted_ = until;
    }
    Time earliest_output(PortIndex) const override { return std::max(granted_, next()); }
    Time lookahead(PortIndex) const override { return 0; }

  private:
    Time next() const {
        return std::min(adapter_.next_event(), task_ < tasks_.size() ? tasks_[task_].time : kNever);
    }
    void run_until(Time until, std::vector<Message>& outbox) {
        for (Time now = next(); now < until; now = next()) {
            if (task_ < tasks_.size() && tasks_[task_].time <= now)
                adapter_.submit(tasks_[task_++].transfer, now);
            std::vector<I2cPhase> begun;
            adapter_.advance(now, begun);
            for (const I2cPhase& phase : begun)
                outbox.push_back({phase.start, 0, phase});
            for (I2cResult& result : adapter_.take_results())
                results_.push_back(std::move(result));
        }
    }

    std::string name_;
    std::vector<Port> ports_{{"i2c", PortKind::I2c}};
    I2cAdapter adapter_;
    std::vector<Task> tasks_;
    std::vector<I2cResult>& results_;
    std::size_t task_ = 0;
    Time granted_ = 0;
};

class BoardNode final : public Node {
  public:
    BoardNode(std::string name, Board& board) : name_(std::move(name)), board_(board) {}

    std::string_view name() const override { return name_; }
    std::span<const Port> ports() const override { return ports_; }
    void advance(Time, std::span<const Message> inbox, std::vector<Message>& outbox) override {
        for (const Message& message : inbox) {
            const auto& phase = std::get<I2cPhase>(message.payload);
            if (phase.kind == I2cPhaseKind::Stop) {
                addressed_ = false;
                continue;
            }
            Time late = 0;
            const I2cPhase said = answer(phase, late);
            outbox.push_back({phase.start + 8 * phase.clock_period + late, 0, said});
        }
    }
    Time earliest_output(PortIndex) const override { return kNever; }
    Time lookahead(PortIndex) const override { return kMicrosecond; }

  private:
    I2cPhase answer(const I2cPhase& phase, Time& late) {
        I2cPhase out = phase;
        out.kind = phase.kind == I2cPhaseKind::Read ? I2cPhaseKind::Data : I2cPhaseKind::Acknowledge;
        if (phase.kind == I2cPhaseKind::Start) {
            addressed_ = phase.byte >> 1 == board_.address && phase.start >= board_.off_until;
            pointer_next_ = true;
        }
        out.ack = addressed_ ? 1 : 0;
        CHECK((addressed_ || phase.kind == I2cPhaseKind::Start));  // the bus asks nobody else
        if (phase.kind == I2cPhaseKind::Read) out.byte = value(pointer_++);
        if (phase.kind == I2cPhaseKind::Write) {
            late = written_++ == board_.hold_byte ? board_.hold : board_.stretch;
            if (!pointer_next_) board_.seen[pointer_] = phase.byte;
            if (pointer_next_) pointer_ = phase.byte;
            pointer_next_ = false;
        }
        return out;
    }
    std::uint8_t value(std::uint8_t number) const {
        const auto found = board_.seen.find(number);
        return found == board_.seen.end() ? board_.fill : found->second;
    }

    std::string name_;
    Board& board_;
    std::vector<Port> ports_{{"i2c", PortKind::I2c}};
    bool addressed_ = false, pointer_next_ = false;
    std::uint8_t pointer_ = 0;
    int written_ = 0;
};

/// Shows its memory at the end.
class Watched final : public pic::PicNode {
  public:
    Watched(const image::Image& image, const pic::PicNodeOptions& options, SharedBus& bus)
        : PicNode(image, options), bus_(bus) {}
    std::string finish() override {
        for (const auto& [name, address] : bus_.watched)
            bus_.words[name] = chip().peek_data(address);
        return PicNode::finish();
    }

  private:
    SharedBus& bus_;
};

}  // namespace

void SharedBus::run() {
    const std::vector<Board> fresh = boards;
    run_once({});
    const std::string first_sha = sha, first_report = report;
    for (const std::uint64_t chop : {1u, 2u, 3u}) {
        boards = fresh;
        run_once(chop);
        CHECK(sha == first_sha);
        CHECK(report == first_report);
    }
}

void SharedBus::run_once(std::optional<std::uint64_t> chop) {
    pic_results.clear();
    linux_results.clear();
    i2c_devices::BusSpec spec;
    spec.hertz = hertz;
    spec.ground_sensor = ground_sensor;
    spec.rgb_turret = false;
    for (std::size_t f = 0; f < faults.size(); ++f)
        spec.faults.push_back({faults[f], Trigger(faults[f], fault_stream(faults[f], seed, f))});
    std::vector<NodeSpec> nodes{{"bus", "", {}}, {"pic", "", {}}, {"linux", "", {}}};
    std::vector<LinkSpec> links{{"i2c.pic", {"pic", "i2c"}, {"bus", "pic"}},
                                {"i2c.linux", {"linux", "i2c"}, {"bus", "linux"}}};
    for (std::size_t b = 0; b < boards.size(); ++b) {
        const std::string name = "board" + std::to_string(b);
        spec.boards.push_back({name});
        nodes.push_back({name, name, {}});
        links.push_back({"i2c." + name, {name, "i2c"}, {"bus", name}});
    }
    if (!main_board.empty()) {
        spec.boards.push_back({"main_board", {}, false, true});
        links.push_back({"i2c.main_board", {"pic", "i2c_slave"}, {"bus", "main_board"}});
    }
    if (!rab_board.empty()) {
        spec.boards.push_back({"rab"});
        nodes.push_back({"rab", "rab", {}});
        links.push_back({"i2c.rab", {"rab", "i2c"}, {"bus", "rab"}});
    }
    nodes[0].json = "bus";
    nodes[1].json = "pic";
    nodes[2].json = "linux";
    const NodeFactory factory = [&](const std::string& name) -> std::unique_ptr<Node> {
        if (name == "bus") return i2c_devices::make_bus_node(spec);
        if (name == "pic" && !main_board.empty()) {
            pic::PicNodeOptions board;
            board.board.name = "pic";
            board.i2c_slave = true;
            board.fastest_i2c_hertz = hertz;
            return std::make_unique<Watched>(assembled(dspic::dspic30f6014a(), main_board), board, *this);
        }
        if (name == "rab") {
            rab::RabNodeOptions board;
            board.board.name = "rab";
            board.fastest_i2c_hertz = hertz;
            return std::make_unique<rab::RabNode>(assembled(dspic::dspic33fj256gp710(), rab_board), board);
        }
        if (name == "pic") return std::make_unique<Master>(name, kPicPeriod, pic, pic_results);
        if (name == "linux")
            return std::make_unique<Master>(name, static_cast<Time>(1e12 / hertz), linux_board,
                                            linux_results);
        return std::make_unique<BoardNode>(name, boards[static_cast<std::size_t>(name.back() - '0')]);
    };
    RunOptions options;
    options.duration = duration;
    options.in_process = true;
    options.chop_seed = chop;
    Conductor conductor(nodes, links, {}, options, factory);
    const Outcome outcome = conductor.run();
    INFO(outcome.text);
    REQUIRE(outcome.success);
    sha = outcome.trace_sha256;
    report = outcome.nodes[0].json;
    pic_report = outcome.nodes[1].json;
}

I2cTransfer writing(std::uint16_t address, std::string bytes) {
    I2cTransfer transfer;
    transfer.timeout = kSecond;
    transfer.messages = {{address, false, false, std::move(bytes), 0}};
    return transfer;
}

I2cTransfer reading(std::uint16_t address, std::uint8_t number, std::uint16_t count) {
    I2cTransfer transfer = writing(address, std::string(1, static_cast<char>(number)));
    transfer.messages.push_back({address, true, false, {}, count});
    return transfer;
}

}  // namespace puckloop::tests
