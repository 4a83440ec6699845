#include "physics/ircom/faults.h"

#include "base/error.h"
#include "protocols/infrared/ircom.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace puckloop::physics {

using cosim::CarriedFault;
using cosim::kMicrosecond;
using cosim::kNever;
using cosim::Time;

namespace {

constexpr Time kShortestHalf = 150 * kMicrosecond, kLongestHalf = 390 * kMicrosecond;  // of a MARK
constexpr double kSeen = 1.0;                                                          // counts
// A word has at least 80 half periods; two MARKs are 20 of them.
constexpr int kFirstHalf = 20, kFewestHalves = 80;
constexpr unsigned kBits = 10;  // data and check

}  // namespace

IrcomFaults::IrcomFaults(std::vector<CarriedFault> faults, IrcomMedium& medium)
    : carried_(std::move(faults)), medium_(medium) {
    if (carried_.empty()) return;
    for (const CarriedFault& fault : carried_) {
        Where where;
        if (!fault.spec.from.empty()) where.from = device_of(fault, fault.spec.from);
        if (const std::string to = fault.spec.parameters.text("to"); !to.empty())
            where.to = device_of(fault, to);
        where_.push_back(where);
    }
    trains_.resize(devices());
    slots_.resize(carried_.size() * devices());
    std::vector<IrcomCopy> copies;
    for (const Where& where : where_)
        for (std::size_t d = 0; d < devices(); ++d)
            copies.push_back({d, 0, where.to});
    medium_.expect_faults(std::move(copies));
}

std::size_t IrcomFaults::device_of(const CarriedFault& fault, const std::string& name) const {
    for (std::size_t d = 0; d < devices(); ++d)
        if (medium_.scene().name(d) == name) return d;
    throw InputError("", "fault " + fault.spec.name, fmt::format("there is no device '{}'", name),
                     "a robot or a TAM");
}

/// Whether its light is there for anybody whom the fault is for.
bool IrcomFaults::reaches(std::size_t sender, const Where& where) const {
    for (std::size_t line = 0; line < medium_.scene().lines(sender); ++line) {
        if ((trains_[sender].all >> line & 1U) == 0) continue;
        for (const IrcomShare& share : medium_.scene().light_of(sender, line))
            if (share.counts >= kSeen && share.device != sender &&
                where.to.value_or(share.device) == share.device)
                return true;
    }
    return false;
}

void IrcomFaults::switched(Time now, std::size_t device, std::uint8_t lines) {
    Train& train = trains_[device];
    const bool edge = (lines != 0) != (train.lines != 0);
    if (edge) {
        const Time gap = now - train.last;
        const bool regular = gap >= kShortestHalf && gap <= kLongestHalf;
        if (train.edges > 0 && (gap >= protocols::IrcomReader::kRest || (!train.word && !regular)))
            rest(device);
        if (train.edges++ == 0) train.start = now;
        train.last = now;
    }
    train.lines = lines;
    train.all |= lines;
    if (!train.word) {
        if (train.edges > 0) train.changes.push_back({now, lines});
        if (edge && train.edges == kPreamble) recognised(now, device);
        return;
    }
    for (std::size_t f = 0; f < carried_.size(); ++f)
        if (slot(f, device).active) follow(f, device, now, edge);
}

void IrcomFaults::rest(std::size_t sender) {
    Train& train = trains_[sender];
    train.edges = 0;
    train.word = false;
    train.all = 0;
    train.changes.clear();
    for (std::size_t f = 0; f < carried_.size(); ++f) {
        slot(f, sender).active = false;
        block(f, sender, false);
    }
}

void IrcomFaults::recognised(Time now, std::size_t sender) {
    Train& train = trains_[sender];
    train.word = true;
    ++train.words;
    for (std::size_t f = 0; f < carried_.size(); ++f) {
        Slot& it = slot(f, sender);
        if (where_[f].from.value_or(sender) != sender || !reaches(sender, where_[f])) continue;
        if (!it.held.empty()) {
            // A word is on its way already; behind this one it comes.
            if (carried_[f].spec.kind == "swap") {
                play(it, it.held, train.start + kAfterWord);
                it.held.clear();
            }
            continue;
        }
        if (carried_[f].trigger.fires(train.start)) begin(f, sender, now);
    }
}

void IrcomFaults::begin(std::size_t f, std::size_t sender, Time now) {
    CarriedFault& fault = carried_[f];
    const std::string& kind = fault.spec.kind;
    const Train& train = trains_[sender];
    Slot& it = slot(f, sender);
    it.active = true;
    it.word = train.words - 1;
    const std::string text = "a word from " + medium_.scene().name(sender);
    if (kind == "clash") {
        it.active = false;
        const auto value = static_cast<std::uint8_t>(
            fault.spec.parameters.has("value") ? fault.spec.parameters.number("value")
                                               : static_cast<double>(fault.trigger.random().below(256)));
        play_word(it, protocols::ircom_symbols(value), medium_.scene().is_booth(sender), train.all, now);
        note(f, train.start, it.word, fmt::format("word {:02X} beside {}", value, text), now);
        return;
    }
    if (kind != "duplicate") block(f, sender, true);
    if (kind == "delay" || kind == "duplicate") {
        it.shift = fault.spec.parameters.time("delay");
        play(it, train.changes, it.shift);
    } else if (kind == "swap" || kind == "flip") {
        for (const Change& change : train.changes)
            it.held.push_back({change.time - train.start, change.lines});
        if (kind == "flip") it.release = train.start + kAfterWord;
    } else if (kind == "corrupt") {
        it.position =
            fault.spec.parameters.has("position")
                ? static_cast<int>(fault.spec.parameters.number("position"))
                : kFirstHalf + static_cast<int>(fault.trigger.random().below(kFewestHalves - kFirstHalf - 1));
        play(it, {{now, train.lines}}, 0);
    } else if (kind == "jitter") {
        it.shift = 0;
        play(it, {{now, train.lines}}, 0);
    }
    // These two say what they did once they did it.
    if (kind != "corrupt" && kind != "flip") note(f, train.start, it.word, text, now);
}

void IrcomFaults::follow(std::size_t f, std::size_t sender, Time now, bool edge) {
    CarriedFault& fault = carried_[f];
    const std::string& kind = fault.spec.kind;
    const Train& train = trains_[sender];
    Slot& it = slot(f, sender);
    if (kind == "delay" || kind == "duplicate") {
        it.queue.push_back({now + it.shift, train.lines});
    } else if (kind == "swap" || kind == "flip") {
        it.all = train.all;
        it.held.push_back({now - train.start, train.lines});
    } else if (kind == "jitter") {
        if (edge)
            it.shift = static_cast<Time>(fault.trigger.random().uniform() *
                                         static_cast<double>(fault.spec.parameters.time("jitter")));
        const Time newest = it.queue.empty() ? now : it.queue.back().time;
        it.queue.push_back({std::max(newest, now + it.shift), train.lines});
    } else if (kind == "corrupt") {
        const int half = train.edges - 1;
        const int halves = static_cast<int>(fault.spec.parameters.number("halves"));
        if (edge && half == it.position)
            note(f, train.start, it.word,
                 fmt::format("half period {} of a word from {}", half, medium_.scene().name(sender)), now);
        if (half < it.position || half >= it.position + halves) it.queue.push_back({now, train.lines});
    }
}

void IrcomFaults::block(std::size_t f, std::size_t sender, bool on) {
    Slot& it = slot(f, sender);
    if (it.blocks == on) return;
    it.blocks = on;
    for (std::size_t receiver = 0; receiver < devices(); ++receiver)
        if (where_[f].to.value_or(receiver) == receiver) medium_.block(sender, receiver, on);
}

void IrcomFaults::play(Slot& slot, const std::vector<Change>& changes, Time shift) {
    for (const Change& change : changes)
        slot.queue.push_back({change.time + shift, change.lines});
}

void IrcomFaults::play_word(Slot& slot, std::uint16_t symbols, bool booth, std::uint8_t lines, Time at) {
    const protocols::IrcomTiming timing = booth ? protocols::kIrcomTam : protocols::kIrcomEpuck;
    for (const protocols::IrcomEdge& edge : protocols::ircom_edges(symbols, timing))
        slot.queue.push_back({at + edge.time, edge.lit ? lines : std::uint8_t{0}});
}

/// flip: the word, which has ended, comes with other symbols.
void IrcomFaults::release(std::size_t f, std::size_t sender) {
    CarriedFault& fault = carried_[f];
    Slot& it = slot(f, sender);
    const Time at = it.release;
    it.release = kNever;
    std::vector<protocols::IrcomEdge> edges;
    for (const Change& change : it.held)
        if (edges.empty() || edges.back().lit != (change.lines != 0))
            edges.push_back({change.time, change.lines != 0});
    const protocols::IrcomReading reading = protocols::read_ircom(edges);
    if (!reading.ok()) {
        // Spoilt as it is.
        play(it, it.held, at);
        it.held.clear();
        return;
    }
    it.held.clear();
    const auto bits = static_cast<unsigned>(fault.spec.parameters.number("bits"));
    std::vector<unsigned> order(kBits);
    std::iota(order.begin(), order.end(), 0U);
    const auto first = static_cast<unsigned>(fault.spec.parameters.number("bit"));
    std::uint16_t symbols = reading.symbols;
    for (unsigned k = 0; k < bits; ++k) {
        if (fault.spec.parameters.has("bit"))
            std::swap(order[k], order[first + k]);
        else
            std::swap(order[k], order[k + fault.trigger.random().below(kBits - k)]);
        symbols = static_cast<std::uint16_t>(symbols ^ 1U << (kBits - 1 - order[k]));
    }
    play_word(it, symbols, medium_.scene().is_booth(sender), it.all, at);
    note(f, at - kAfterWord, it.word,
         fmt::format("a word from {}: {} arrives as {}", medium_.scene().name(sender),
                     protocols::ircom_text(reading.symbols), protocols::ircom_text(symbols)),
         at);
}

Time IrcomFaults::next() const {
    Time next = kNever;
    for (const Slot& one : slots_) {
        next = std::min(next, one.release);
        if (!one.queue.empty()) next = std::min(next, one.queue.front().time);
    }
    return next;
}

bool IrcomFaults::apply(Time now) {
    bool changed = false;
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        Slot& it = slots_[i];
        if (it.release <= now) release(i / devices(), i % devices());
        for (; !it.queue.empty() && it.queue.front().time <= now; it.queue.pop_front()) {
            medium_.copy(i).lines = it.queue.front().lines;
            changed = true;
        }
    }
    return changed;
}

void IrcomFaults::note(std::size_t f, Time start, std::uint64_t word, std::string what, Time now) {
    carried_[f].evidence.fire({start, word, {}, std::move(what)}, now);
}

}  // namespace puckloop::physics
