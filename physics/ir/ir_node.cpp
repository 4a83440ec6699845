#include "physics/ir/ir_node.h"

#include "base/error.h"
#include "base/json.h"
#include "base/states/checkpoint.h"
#include "physics/description/robot_parameters.h"
#include "physics/ir/ir_faults.h"
#include "physics/ir/ir_frames.h"
#include "physics/ir/ir_receiver.h"
#include "physics/ir/virtual_senders.h"
#include "physics/world/pose_signals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace puckloop::physics {

using cosim::kNever;
using cosim::Message;
using cosim::PortIndex;
using cosim::Time;

namespace {

constexpr std::uint16_t kUnusedPort = 0xFFFF;
constexpr int kCarrier = kIrSensors;
constexpr int kPower = kIrSensors + 1;
constexpr int kNothing = -1;

/// The ids of one board's link, both ways.
struct BoardSignals {
    std::vector<int> meaning;  ///< of an incoming id: emitter 0..11, kCarrier, kPower, kNothing
    std::array<std::uint16_t, 2 * kIrSensors> output;  ///< id of each IrOutput::index

    explicit BoardSignals(const Robot& robot) {
        const auto id = [&](const std::string& name) {
            const auto found = robot.rab_signals.find(name);
            return found == robot.rab_signals.end() ? kUnusedPort : found->second;
        };
        const auto read = [&](const std::string& name, int what) {
            const auto number = id(name);
            if (number == kUnusedPort) return;
            if (meaning.size() <= number) meaning.resize(number + 1U, kNothing);
            meaning[number] = what;
        };
        for (int i = 0; i < kIrSensors; ++i) {
            const auto number = std::to_string(i + 1);
            read("emitter" + number, i);
            output[static_cast<std::size_t>(i)] = id("demod" + number);
            output[static_cast<std::size_t>(kIrLevelOutput + i)] = id("peak" + number);
        }
        read("carrier", kCarrier);
        read("power", kPower);
    }
};

World checked_for_ir(const World& world) {
    check(world);
    if (!has_rab(world)) throw InputError(world.file, "", "no robot has a range-and-bearing board");
    return world;
}

}  // namespace

struct IrNode::Impl : cosim::Rewindable {
    Impl(const World& world, const IrNodeOptions& options);

    PortIndex world_port() const { return static_cast<PortIndex>(receivers.size()); }
    void take(const Message& message);
    void take_scene(std::size_t id, double value);
    void take_virtual_pose(std::size_t number, double value);
    /// Everything stamped `now` has been taken.
    void apply(Time now);
    /// The sender's light has changed; `everywhere`: at boards that it no longer reaches, too.
    void reach(std::size_t sender, bool everywhere);
    /// Lights again what faults have changed.
    void show_faults();
    /// The next instant at which something changes without a message.
    Time next() const { return std::min(faults ? faults->next() : kNever, senders.next()); }
    void release(Time until, std::vector<Message>& outbox);

    void mark() override;
    void rewind() override;
    void settle() override;
    /// Between two advances nothing is marked as moved, touched or reached.
    template <class Archive>
    void state(Archive& archive) {
        archive(medium, frames);
        for (IrReceiver& receiver : receivers)
            archive(receiver);
        archive(looked, poses, masks, granted, senders);
        if (faults) archive(*faults);
    }

    World world;
    std::string name;
    std::vector<cosim::Port> ports;
    IrMedium medium;
    IrFrames frames;
    std::vector<BoardSignals> signals;
    std::vector<IrReceiver> receivers;
    std::vector<Time> refresh, looked;  ///< period, and when the board's coupling was last looked at
    std::vector<std::array<double, kPoseSignals>> poses;  ///< bodies, then virtual boards
    std::size_t described = 0;                            ///< bodies among them
    std::vector<bool> moved, touched;  ///< bodies and boards changed by the messages of one instant
    std::vector<bool> reached;         ///< boards at which the light changed with them
    std::vector<std::uint16_t> masks;
    std::vector<IrOutput> released;
    VirtualSenders senders;
    std::unique_ptr<IrFaults> faults;  ///< null: none was asked for
    Time granted = 0;
    bool any_moved = false;
    std::map<std::size_t, ShapeValues> shapes;  ///< by number of the first signal
    std::set<std::size_t> altered;              ///< of those, by the messages of one instant

    Checkpoint checkpoint;
    bool marked = false;
    std::optional<std::map<std::size_t, ShapeValues>> shapes_at_mark;  ///< set once they have changed
};

IrNode::Impl::Impl(const World& description, const IrNodeOptions& options)
    : world(checked_for_ir(description)),
      name(options.name),
      medium(world, options.changes),
      frames(medium, options.frames_csv),
      senders(world, cosim::from_seconds(with({}, world.parameters).ir.chip)) {
    for (const Robot& robot : world.robots) {
        poses.push_back({robot.x, robot.y, robot.heading});
        if (!robot.rab) continue;
        ports.push_back({robot.name + ".ir", cosim::PortKind::Signals});
        signals.emplace_back(robot);
        receivers.emplace_back(medium.parameters(receivers.size()));
        refresh.push_back(cosim::from_seconds(medium.parameters(refresh.size()).refresh));
    }
    ports.push_back({"world", cosim::PortKind::Signals});
    for (std::size_t board = receivers.size(); board < medium.board_count(); ++board)
        refresh.push_back(cosim::from_seconds(medium.parameters(board).refresh));
    for (const Box& box : world.boxes)
        if (box.movable) poses.push_back({box.x, box.y, box.heading});
    for (const Cylinder& cylinder : world.cylinders)
        if (cylinder.movable) poses.push_back({cylinder.x, cylinder.y, 0.0});
    const auto fixed = fixed_shapes(world);
    for (std::size_t i = 0; i < fixed.size(); ++i)
        shapes[2 * i] = values_of(fixed[i]);  // numbered as SceneSignals::shape() does
    described = poses.size();
    for (const VirtualBoard& board : world.virtuals.boards)
        poses.push_back({board.x, board.y, board.heading});
    moved.resize(poses.size());
    touched.resize(medium.board_count());
    reached.resize(receivers.size());
    masks.resize(medium.board_count());
    looked.resize(medium.board_count());
    if (!options.faults.empty()) {
        faults = std::make_unique<IrFaults>(options.faults, medium);
        medium.set_fault_effects(faults.get());
    }
    for (std::size_t r = 0; r < receivers.size(); ++r)
        receivers[r].see(0, medium.at(r));
}

void IrNode::Impl::take(const Message& message) {
    const auto* signal = std::get_if<cosim::Signal>(&message.payload);
    if (signal == nullptr) return;
    if (message.port == world_port()) {
        if (is_virtual_board_signal(signal->id)) {
            take_virtual_pose(virtual_board_signal(0, 0) - signal->id, signal->value);
            return;
        }
        const std::size_t body = signal->id / kPoseSignals;
        if (body >= described) {
            take_scene(signal->id, signal->value);
            return;
        }
        poses[body][signal->id % kPoseSignals] = signal->value;
        moved[body] = any_moved = true;
        return;
    }
    const std::size_t board = message.port;
    const auto& meaning = signals[board].meaning;
    const int what = signal->id < meaning.size() ? meaning[signal->id] : kNothing;
    if (what == kNothing) return;
    touched[board] = true;
    if (what == kCarrier)
        medium.set_carrier(board, signal->value);
    else if (what == kPower)
        medium.set_power(board, signal->value);
    else if (signal->value != 0.0)
        masks[board] = static_cast<std::uint16_t>(masks[board] | 1U << what);
    else
        masks[board] = static_cast<std::uint16_t>(masks[board] & ~(1U << what));
}

void IrNode::Impl::take_virtual_pose(std::size_t number, double value) {
    const std::size_t body = described + number / kPoseSignals;
    if (body >= poses.size()) return;
    poses[body][number % kPoseSignals] = value;
    moved[body] = any_moved = true;
}

/// A body lifted or taken away, a shape changed: once all of the instant is here, for a shape.
void IrNode::Impl::take_scene(std::size_t id, double value) {
    const SceneSignals ids{described};
    any_moved = true;
    if (id < ids.out(described)) {
        medium.set_out(id - ids.out(0), value != 0.0);
        return;
    }
    if (marked && !shapes_at_mark) shapes_at_mark = shapes;
    const std::size_t offset = id - ids.shape(true, 0);
    shapes[offset / kShapeSignals][offset % kShapeSignals] = value;
    altered.insert(offset / kShapeSignals);
}

void IrNode::Impl::reach(std::size_t sender, bool everywhere) {
    for (std::size_t r = 0; r < receivers.size(); ++r)
        if (everywhere || medium.coupled(sender, r)) reached[r] = true;
}

void IrNode::Impl::show_faults() {
    for (std::size_t s = 0; s < medium.board_count(); ++s) {
        if (!faults->again(s)) continue;
        medium.relight_anew(s);
        reach(s, true);
    }
    for (std::size_t r = 0; r < receivers.size(); ++r)
        if (faults->shone(r)) reached[r] = true;
}

void IrNode::Impl::apply(Time now) {
    frames.close_until(now);
    for (auto& receiver : receivers)
        receiver.run_to(now);
    if (faults && faults->next() <= now) {
        faults->act(now);
        show_faults();
    }
    senders.act(now, [this](std::size_t number, bool lit) {
        constexpr std::uint16_t kAll = (1U << kIrSensors) - 1;
        touched[receivers.size() + number] = true;
        masks[receivers.size() + number] = lit ? kAll : 0;
    });
    if (any_moved) {
        for (std::size_t i = 0; i < poses.size(); ++i)
            if (moved[i]) medium.move(i, poses[i][0], poses[i][1], poses[i][2]);
        std::fill(moved.begin(), moved.end(), false);
        for (const std::size_t number : altered)
            medium.set_shape(number % 2 == 0, number / 2, shape_from(shapes[number]));
        altered.clear();
        any_moved = false;
        for (std::size_t s = 0; s < medium.board_count(); ++s) {
            if (medium.emitters(s) == 0 || touched[s] || now - looked[s] < refresh[s]) continue;
            looked[s] = now;
            if (medium.refresh(s)) reach(s, true);
        }
    }
    // All boards change at once: only then do receivers look.
    for (std::size_t s = 0; s < medium.board_count(); ++s) {
        if (!touched[s]) continue;
        touched[s] = false;
        medium.set_emitters(s, masks[s]);
        bool everywhere = false;
        const bool begins = frames.edge(now, s, masks[s] != 0);
        if (begins) {
            medium.begin_burst(s, cosim::to_seconds(now));
            looked[s] = now;
        } else {
            everywhere = medium.relight(s);
        }
        if (faults) {
            faults->emits(now, s, masks[s], begins);
            show_faults();
        }
        if (masks[s] != 0) frames.seen(s);
        reach(s, everywhere);
    }
    for (std::size_t r = 0; r < receivers.size(); ++r) {
        if (!reached[r]) continue;
        reached[r] = false;
        receivers[r].see(now, medium.at(r));
    }
}

void IrNode::Impl::mark() {
    settle();
    marked = true;
    frames.mark();
    medium.mark();
    checkpoint.take(*this);
}

void IrNode::Impl::rewind() {
    frames.rewind();
    medium.rewind();
    checkpoint.restore(*this);
    if (shapes_at_mark) shapes = std::move(*shapes_at_mark);
    shapes_at_mark.reset();
    // An advance that threw may have left some.
    moved.assign(moved.size(), false);
    touched.assign(touched.size(), false);
    reached.assign(reached.size(), false);
    any_moved = false;
    altered.clear();
}

void IrNode::Impl::settle() {
    marked = false;
    shapes_at_mark.reset();
    medium.settle();
    frames.settle();
}

void IrNode::Impl::release(Time until, std::vector<Message>& outbox) {
    for (std::size_t r = 0; r < receivers.size(); ++r) {
        receivers[r].run_to(until);
        released.clear();
        receivers[r].release(until, released);
        for (const IrOutput& output : released) {
            const auto id = signals[r].output[output.index];
            if (id == kUnusedPort) continue;
            outbox.push_back({output.time, static_cast<PortIndex>(r), cosim::Signal{id, output.value}});
        }
    }
}

IrNode::IrNode(const World& world, const IrNodeOptions& options)
    : impl_(std::make_unique<Impl>(world, options)) {}

IrNode::~IrNode() = default;

std::string_view IrNode::name() const {
    return impl_->name;
}

std::span<const cosim::Port> IrNode::ports() const {
    return impl_->ports;
}

void IrNode::advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
    auto& ir = *impl_;
    for (auto next = inbox.begin();;) {
        Time now = next != inbox.end() ? next->time : kNever;
        const Time due = ir.next();
        if (due < until || (next != inbox.end() && due < now)) now = std::min(now, due);
        if (now == kNever) break;
        for (; next != inbox.end() && next->time == now; ++next)
            ir.take(*next);
        ir.apply(now);
    }
    ir.release(until, outbox);
    ir.granted = until;
}

Time IrNode::earliest_output(PortIndex port) const {
    if (port >= impl_->receivers.size()) return kNever;
    const IrReceiver& receiver = impl_->receivers[port];
    const Time own = impl_->next();
    return own == kNever ? receiver.next_output()
                         : std::min(receiver.next_output(), cosim::later(own, receiver.lookahead()));
}

Time IrNode::lookahead(PortIndex port) const {
    if (port >= impl_->receivers.size() || !impl_->medium.can_hear(port)) return kNever;
    return impl_->receivers[port].lookahead();
}

cosim::Rewindable* IrNode::rewindable() {
    return impl_.get();
}

std::string IrNode::finish() {
    std::string json = R"({"boards":)" + impl_->frames.finish();
    if (impl_->faults)
        json += R"(,"faults":)" + cosim::fault_results(impl_->faults->faults(), impl_->granted).dump();
    return json + "}";
}

}  // namespace puckloop::physics
