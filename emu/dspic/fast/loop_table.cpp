#include "emu/dspic/fast/loop_table.h"

#include "emu/dspic/fast/idle_loops.h"
#include "emu/dspic/machine/machine.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace puckloop::dspic {

namespace {

using Access = LoopTrace::Access;
using Boundary = LoopTrace::Boundary;
using Word = LoopTable::Word;

class TableMaker {
  public:
    TableMaker(Machine& m, const IdleLoops::Plan& plan, const LoopTrace& trace, LoopTable& table)
        : trace_(trace), table_(table), count_(trace.boundaries.size()) {
        clear();
        table_.trace = &trace;
        table_.cycles = plan.cycles;
        table_.layout = plan.layout;
        for (std::size_t i = 0; i < plan.polled_count; ++i)
            table_.polled.push_back({&m.sfr.raw(plan.polled[i].address), plan.polled[i].value});
        for (std::size_t i = 0; i < plan.count; ++i) {
            const std::uint16_t key = plan.cells[i].key;
            keys_[i] = key;
            table_.cells.push_back(key < 16 ? &m.st.w[key] : m.ram + (key - kRamStart) / 2);
        }
    }
    void run() {
        table_.places.reserve(count_ + 1);
        table_.checks.reserve(count_ * table_.cells.size());
        table_.changes.reserve(count_ * table_.cells.size());
        list_instructions();
        for (std::size_t at = 0; at < count_; ++at)
            list_words(at);
        table_.places.push_back({});
        close_lists();
        list_dc();
    }

  private:
    /// The lists' memory is used again: tables are made often.
    void clear() {
        table_.keep = table_.uses = 0;
        table_.first_at.clear();
        table_.places.clear();
        table_.cells.clear();
        table_.checks.clear();
        table_.changes.clear();
        table_.polled.clear();
    }

    void list_instructions() {
        table_.keep = 0xFFFFFFFF;
        const Op* before = trace_.boundaries.back().op;
        std::uint16_t inner = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            const Boundary& at = trace_.boundaries[i];
            table_.first_at.resize(at.offset + 1, static_cast<std::uint16_t>(i));
            table_.keep &= at.op->keep;
            table_.uses |= at.op->uses & 0xFFFF0000;
            LoopTable::Place place{
                .op = at.op, .offset = at.offset, .watch = before->writes, .stall = at.stall};
            place.returns = shortened_by_exception(*at.op);
            place.known = static_cast<std::uint16_t>(at.known & ~sr::DC);
            place.flags = at.flags;
            place.inner = inner;
            table_.places.push_back(place);
            before = at.op;
            if (at.op->may_skip && i + 1 != count_ && trace_.boundaries[i + 1].op != at.op + 1) ++inner;
        }
        table_.first_at.resize(table_.cycles, static_cast<std::uint16_t>(count_));
    }

    /// Instructions from one boundary, in this iteration or the one before, up to another.
    std::uint16_t age(std::size_t from, std::size_t to) const {
        return static_cast<std::uint16_t>(from < to ? to - from : to + count_ - from);
    }

    void list_words(std::size_t at) {
        LoopTable::Place& place = table_.places[at];
        close_lists(place);
        for (std::size_t cell = 0; cell < table_.cells.size(); ++cell) {
            bool live = true;
            Word word = keys_[cell] < 16 ? of_register(at, keys_[cell]) : of_ram(at, keys_[cell], live);
            if (keys_[cell] < 16) word.age = ages_[cell] = register_age(at, keys_[cell], ages_[cell]);
            word.cell = static_cast<std::uint16_t>(cell);
            if (live) table_.checks.push_back(word);
            if (word.age != 0) insert_by_age(place.changes, word);
        }
    }
    /// Behind those of the same age; there are a few.
    void insert_by_age(std::uint32_t first, const Word& word) {
        auto at = table_.changes.end();
        const auto begin = table_.changes.begin() + static_cast<std::ptrdiff_t>(first);
        while (at != begin && std::prev(at)->age > word.age)
            --at;
        table_.changes.insert(at, word);
    }
    void close_lists(LoopTable::Place& place) const {
        place.checks = static_cast<std::uint32_t>(table_.checks.size());
        place.changes = static_cast<std::uint32_t>(table_.changes.size());
    }
    void close_lists() { close_lists(table_.places.back()); }

    Word of_register(std::size_t at, std::uint16_t reg) const {
        const Boundary& boundary = trace_.boundaries[at];
        return {0, boundary.w[reg], boundary.w_steps[reg], 0};
    }
    /// `before`: at the boundary before this one.
    std::uint16_t register_age(std::size_t at, std::uint16_t reg, std::uint16_t before) const {
        const auto writes = [&](std::size_t i) { return (trace_.boundaries[i].writes >> reg & 1) != 0; };
        if (at != 0)
            return writes(at - 1) ? std::uint16_t{1}
                   : before == 0  ? before
                                  : static_cast<std::uint16_t>(before + 1);
        for (std::size_t i = count_; i-- > 0;)
            if (writes(i)) return age(i, 0);
        return 0;
    }
    Word of_ram(std::size_t at, std::uint16_t address, bool& live) const {
        const Access *first = nullptr, *last = nullptr, *before = nullptr, *next = nullptr;
        Word word;
        for (const Access& access : trace_.accesses) {
            if (access.address != address) continue;
            if (!first) first = &access;
            if (access.boundary < at) before = &access;
            if (access.boundary >= at && !next) next = &access;
            if (access.write) see_write(word, age(access.boundary, at));
            last = &access;
        }
        live = !(next ? next : first)->write;
        // The last access before is of this iteration, or of the one before.
        const Access& latest = before ? *before : *last;
        word.step = latest.step;
        word.value = static_cast<std::uint16_t>(latest.value - (before ? 0 : latest.step));
        return word;
    }
    static void see_write(Word& word, std::uint16_t age) {
        if (word.age == 0 || age < word.age) word.age = age;
    }

    void list_dc() {
        std::size_t setter = count_;                    // none yet
        for (std::size_t i = 0; i < 2 * count_; ++i) {  // the first time round finds what the head still has
            const std::size_t at = i % count_;
            if (setter != count_) {
                table_.places[at].dc_age = age(setter, at);
                table_.places[at].dc_from = static_cast<std::uint16_t>(setter);
            }
            if (trace_.boundaries[at].sum.done) setter = at;
        }
    }

    const LoopTrace& trace_;
    LoopTable& table_;
    std::size_t count_;
    std::array<std::uint16_t, IdleLoops::Plan::kMostCells> keys_{};
    std::array<std::uint16_t, IdleLoops::Plan::kMostCells>
        ages_{};  ///< of registers, at the boundary that is listed
};

/// Other branches that come round on the way count as part of the loop (waits/).
bool others_inside(const LoopTrace& trace) {
    const LoopTrace::Boundary &head = trace.boundaries.front(), &last = trace.boundaries.back();
    return std::all_of(trace.boundaries.begin(), trace.boundaries.end(), [&](const LoopTrace::Boundary& at) {
        return !at.op->may_skip || (at.op >= head.op && at.op <= last.op) || at.w[15] > last.w[15];
    });
}

}  // namespace

void make_table(Machine& m, IdleLoops::Branch& known) {
    ++m.skip->work.loop_tables;
    if (!others_inside(known.trace)) known.trace.iterations = 0;
    known.table.gained = &known.plan.gained;
    TableMaker(m, known.plan, known.trace, known.table).run();
}

}  // namespace puckloop::dspic
