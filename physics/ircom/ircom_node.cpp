#include "physics/ircom/ircom_node.h"

#include "base/error.h"
#include "base/json.h"
#include "base/states/checkpoint.h"
#include "physics/ircom/comparator.h"
#include "physics/ircom/faults.h"
#include "physics/ircom/words.h"

#include <algorithm>
#include <deque>

namespace puckloop::physics {

using cosim::kNever;
using cosim::Message;
using cosim::PortIndex;
using cosim::Time;

namespace {

World checked_for_ircom(const World& world) {
    check(world);
    return world;
}

/// What is to leave by one port.
struct Output {
    Time time = 0;
    std::uint16_t id = 0;
    double value = 0.0;
};

}  // namespace

struct IrcomNode::Impl : cosim::Rewindable {
    Impl(const World& world, const IrcomNodeOptions& options);

    std::size_t devices() const { return medium.scene().device_count(); }
    bool take(const Message& message);
    /// Everything stamped `now` has been taken, and the scene has gone on to it.
    void apply(Time now);
    /// Comparators that switch at or before `now`.
    void run_to(Time now);

    void mark() override;
    void rewind() override;
    void settle() override;
    template <class Archive>
    void state(Archive& archive) {
        archive(medium, words, comparators, granted);
        if (!faults.empty()) archive(faults);
        for (auto& queue : outputs)
            archive(queue);
    }

    IrcomNodeOptions options;
    std::vector<cosim::Port> ports;
    IrcomMedium medium;
    IrcomFaults faults;
    IrcomWords words;
    std::vector<IrcomComparator> comparators;  // of the booths
    std::vector<std::deque<Output>> outputs;   // by port
    std::vector<Time> delays;
    std::size_t first_booth = 0;
    Time granted = 0;
    std::vector<std::uint8_t> was_lit;  // scratch of one instant, like these
    std::vector<std::size_t> switched;
    std::vector<IrcomLight> changed;
    Checkpoint checkpoint;
};

IrcomNode::Impl::Impl(const World& world, const IrcomNodeOptions& given)
    : options(given),
      medium(checked_for_ircom(world), given.changes),
      faults(given.faults, medium),
      words(medium, given.words_csv) {
    const IrcomScene& scene = medium.scene();
    for (std::size_t d = 0; d < scene.device_count(); ++d) {
        const IrcomParameters& parameters = scene.parameters(d);
        ports.push_back({scene.name(d) + ".ircom", cosim::PortKind::Signals});
        delays.push_back(cosim::from_seconds(parameters.delay));
        if (scene.is_booth(d))
            comparators.emplace_back(parameters.tam_threshold, parameters.tam_time);
        else
            first_booth = d + 1;
    }
    outputs.resize(ports.size());
    was_lit.resize(ports.size());
    ports.push_back({"world", cosim::PortKind::Signals});
}

/// True if a line was switched.
bool IrcomNode::Impl::take(const Message& message) {
    const auto* signal = std::get_if<cosim::Signal>(&message.payload);
    if (signal == nullptr) return false;
    if (message.port == devices()) {
        medium.scene().take(message.time, signal->id, signal->value);
        return false;
    }
    const std::size_t device = message.port;
    std::size_t line = 0;
    if (medium.scene().is_booth(device)) {
        if (signal->id != options.ids.emit) return false;
    } else {
        const auto& pulses = options.ids.pulse;
        const auto found = std::find(pulses.begin(), pulses.end(), signal->id);
        if (found == pulses.end()) return false;
        line = static_cast<std::size_t>(found - pulses.begin());
    }
    if (std::find(switched.begin(), switched.end(), device) == switched.end()) {
        switched.push_back(device);
        was_lit[device] = medium.lit(device) ? 1 : 0;
    }
    medium.set(device, line, signal->value != 0.0);
    return true;
}

void IrcomNode::Impl::run_to(Time now) {
    for (std::size_t b = 0; b < comparators.size(); ++b) {
        IrcomComparator& comparator = comparators[b];
        if (comparator.crossing() > now) continue;
        const Time at = comparator.crossing();
        comparator.cross();
        const std::size_t device = first_booth + b;
        outputs[device].push_back({at + delays[device], options.ids.sense, comparator.high() ? 1.0 : 0.0});
    }
}

void IrcomNode::Impl::apply(Time now) {
    run_to(now);
    const bool moved = medium.scene().apply(now);
    words.close_until(now);
    for (const std::size_t device : switched) {
        const bool lit = medium.lit(device);
        if (lit != (was_lit[device] != 0)) words.edge(now, device, lit);
        if (lit) words.seen(device);
        if (!faults.empty()) faults.switched(now, device, medium.lines(device));
    }
    const bool copied = !faults.empty() && faults.apply(now);
    if (switched.empty() && !copied && !(moved && medium.any_lit())) return;
    switched.clear();
    changed.clear();
    medium.update(changed);
    for (const IrcomLight& light : changed) {
        if (light.device >= first_booth)
            comparators[light.device - first_booth].see(now, light.counts);
        else
            outputs[light.device].push_back(
                {now + delays[light.device], options.ids.light[light.sensor], light.counts});
    }
}

void IrcomNode::Impl::mark() {
    settle();
    words.mark();
    checkpoint.take(*this);
}

void IrcomNode::Impl::rewind() {
    words.rewind();
    checkpoint.restore(*this);
    switched.clear();
}

void IrcomNode::Impl::settle() {
    words.settle();
}

IrcomNode::IrcomNode(const World& world, const IrcomNodeOptions& options)
    : impl_(std::make_unique<Impl>(world, options)) {}

IrcomNode::~IrcomNode() = default;

std::string_view IrcomNode::name() const {
    return impl_->options.name;
}

std::span<const cosim::Port> IrcomNode::ports() const {
    return impl_->ports;
}

void IrcomNode::advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
    auto& ir = *impl_;
    auto next = inbox.begin();
    while (true) {
        const Time message = next == inbox.end() ? kNever : next->time;
        const Time now = std::min({message, ir.medium.scene().next_change(), ir.faults.next()});
        if (now >= until) break;
        for (; next != inbox.end() && next->time == now; ++next)
            ir.take(*next);
        ir.apply(now);
    }
    ir.run_to(until - 1);
    ir.granted = until;
    // What comes in from `until` on shows after a device's delay: all that is due before is settled.
    for (std::size_t d = 0; d < ir.outputs.size(); ++d)
        for (auto& queue = ir.outputs[d]; !queue.empty() && queue.front().time < until + ir.delays[d];
             queue.pop_front())
            outbox.push_back({queue.front().time, static_cast<PortIndex>(d),
                              cosim::Signal{queue.front().id, queue.front().value}});
}

Time IrcomNode::earliest_output(PortIndex port) const {
    const auto& ir = *impl_;
    if (port >= ir.devices()) return kNever;
    if (!ir.outputs[port].empty()) return ir.outputs[port].front().time;
    Time first = kNever;
    if (ir.medium.any_lit()) first = ir.medium.scene().next_change();
    first = std::min(first, ir.faults.next());
    if (port >= ir.first_booth) first = std::min(first, ir.comparators[port - ir.first_booth].crossing());
    return cosim::later(first, ir.delays[port]);
}

Time IrcomNode::lookahead(PortIndex port) const {
    const auto& ir = *impl_;
    if (port >= ir.devices() || ir.devices() < 2) return kNever;
    return ir.medium.scene().near(port) ? ir.delays[port] : kIrcomPoseDelay;
}

cosim::Rewindable* IrcomNode::rewindable() {
    return impl_.get();
}

std::string IrcomNode::finish() {
    std::string report = R"({"devices":)" + impl_->words.finish();
    if (!impl_->faults.empty())
        report += R"(,"faults":)" + cosim::fault_results(impl_->faults.carried(), impl_->granted).dump();
    return report + "}";
}

}  // namespace puckloop::physics
