#include "emu/dspic/fast/isr_path.h"

#include "emu/dspic/fast/idle_loops.h"
#include "emu/dspic/fast/known_services.h"
#include "emu/dspic/fast/path_domain.h"
#include "emu/dspic/machine/machine.h"
#include "emu/dspic/waits/wait_watch.h"

#include <algorithm>
#include <array>

namespace puckloop::dspic {

namespace {

constexpr std::size_t kMostPaths = 96;
constexpr std::size_t kMostStores = 64;
/// Walks that are made whenever no path holds. One costs what some hundred services do.
constexpr std::uint32_t kFreeWalks = 12;
/// Services between later ones; twice as many after each that did not pay. A prime: what takes turns is met
/// at every turn.
constexpr std::uint32_t kPause = 61, kMostDoublings = 6;
/// Hits after which a walk has paid.
constexpr std::uint32_t kPaid = 48;
/// With fewer than one hit to so many misses, after so many, paths are left alone for so many services.
constexpr std::uint32_t kMissesPerHit = 4, kMostMisses = 128, kRest = 1024;

Arrival arrival_of(const Machine& m, const IsrPath::Arrival& arrival, Cycle at, const Service& service) {
    return {arrival.branch, arrival.head, static_cast<std::uint16_t>(m.st.w[15] + arrival.depth),
            service.level, service.start + at};
}

/// A loop on the path is one that the program has stayed in for so long that it is to be looked at.
bool looks(const Machine& m, const IsrPath& path, const Service& service) {
    return std::any_of(path.arrivals.begin(), path.arrivals.end(), [&](const IsrPath::Arrival& arrival) {
        return needs_look(m, arrival_of(m, arrival, arrival.last, service));
    });
}

/// All that the path rests on.
bool holds(const Machine& m, const IsrPath& path, const Service& service) {
    for (const IsrPath::Guard& guard : path.guards)
        if (!guard.holds()) return false;
    const std::uint16_t stack = m.st.w[15];
    return (path.uses & m.watch & 0xFFFF0000) == 0 && stack_holds(m, path.depth, stack) &&
           (path.highest < stack || path.lowest >= stack + path.depth) &&
           (!path.converts ||
            service.start + path.last_conversion < m.sfr.plain().until[SfrSpace::Plain::kConverter]) &&
           !looks(m, path, service);
}

IsrPaths* paths_of(Machine& m, int vector) {
    auto& known = m.services->paths;
    const auto index = static_cast<std::size_t>(vector);
    if (known.size() <= index) known.resize(index + 1);
    const std::uint32_t table = m.irq.alternate_table() ? m.device.aivt : m.device.ivt;
    const std::uint32_t handler = m.program[table / 2 + index] & kProgramSpace;
    if (handler / 2 >= m.code_words) return nullptr;
    IsrPaths& all = known[index];
    if (all.handler != handler || all.layout != m.sfr.layout_changes()) {
        all = {};
        all.handler = handler;
        all.layout = m.sfr.layout_changes();
        all.credit = kFreeWalks;
    }
    return &all;
}

const IsrPath* hit(IsrPaths& all, std::size_t index) {
    all.paths[all.recent].next = index;
    all.recent = index;
    all.misses -= std::min(all.misses, kMissesPerHit);
    ++all.hits;
    return &all.paths[index];
}

const IsrPath* find_path(const Machine& m, IsrPaths& all, const Service& service) {
    if (all.paths.empty()) return nullptr;
    const std::size_t expected = all.paths[all.recent].next;
    if (holds(m, all.paths[expected], service)) return hit(all, expected);
    for (std::size_t i = 0; i < all.paths.size(); ++i)
        if (i != expected && holds(m, all.paths[i], service)) return hit(all, i);
    if (++all.misses >= kMostMisses) {
        all.misses = 0;
        all.rest = kRest;
    }
    return nullptr;
}

bool may_walk(IsrPaths& all) {
    if (all.pause == 0) return true;
    --all.pause;
    return false;
}

/// Neither paths nor walks are of use to the routine for now.
bool is_left_alone(Machine& m, int vector) {
    const auto index = static_cast<std::size_t>(vector);
    if (index >= m.services->paths.size()) return false;
    IsrPaths& all = m.services->paths[index];
    std::uint32_t& services = all.paths.empty() ? all.pause : all.rest;
    if (services == 0) return false;
    --services;
    return true;
}

void pause_walks(IsrPaths& all, bool walked) {
    if (walked && all.credit > 0) {
        --all.credit;
        return;
    }
    all.failures = all.hits >= kPaid ? 0 : std::min(all.failures + 1, kMostDoublings);
    all.pause = kPause << all.failures;
    all.hits = 0;
}

void learn_path(Machine& m, IsrPaths& all, int irq, const Service& service) {
    ++m.skip->work.path_walks;
    IsrPath fresh;
    const bool walked = PathDomain(m, fresh, irq, service.start).walk(m.code + all.handler / 2) &&
                        holds(m, fresh, service) && fresh.stores.size() <= kMostStores;
    pause_walks(all, walked);
    if (!walked) return;
    ++m.skip->work.paths;
    if (all.paths.size() == kMostPaths) {
        all.paths.clear();
        all.recent = 0;
    }
    const std::size_t index = all.paths.size();
    if (index != 0) all.paths[all.recent].next = index;
    all.paths.push_back(std::move(fresh));
    all.recent = index;
}

void store_at_once(const IsrPath& path) {
    std::array<std::uint16_t, kMostStores> values;
    for (std::size_t i = 0; i < path.stores.size(); ++i)
        values[i] = path.stores[i].term.value();
    for (std::size_t i = 0; i < path.stores.size(); ++i)
        *path.stores[i].to = values[i];
}

}  // namespace

bool has_paths(const Machine& m, int vector) {
    const auto index = static_cast<std::size_t>(vector);
    return index < m.services->paths.size() && !m.services->paths[index].paths.empty();
}

const IsrPath* isr_path(Machine& m, int vector, const Service& service) {
    if (vector < kTrapVectors || is_left_alone(m, vector)) return nullptr;
    IsrPaths* const all = paths_of(m, vector);
    if (!all) return nullptr;
    const IsrPath* const path = find_path(m, *all, service);
    if (!path && may_walk(*all)) learn_path(m, *all, vector - kTrapVectors, service);
    return path;
}

void take_path(Machine& m, const IsrPath& path, const Service& service) {
    for (const IsrPath::Arrival& arrival : path.arrivals) {
        if (!arrival.branch->may_skip) continue;  // nobody waits there
        note_arrival(m, arrival_of(m, arrival, arrival.first, service));
        note_arrival(m, arrival_of(m, arrival, arrival.last, service));
    }
    if (path.sum.done) {
        const std::uint32_t a = path.sum.a.value(), b = path.sum.b.value();
        const std::uint32_t carries = a ^ b ^ (a + b + (path.sum.carry ? 1u : 0u));
        const std::uint32_t dc = (path.sum.byte ? carries << 4 : carries) & sr::DC;
        m.st.sr = static_cast<std::uint16_t>((m.st.sr & ~sr::DC) | dc);
    }
    const std::uint32_t pc = m.pc_of(m.current);
    std::uint16_t* const stack = m.ram + (m.st.w[15] - kRamStart) / 2;
    stack[0] = stacked_pc_low(pc);
    stack[1] = stacked_status(m.st.sr, m.st.corcon, pc);
    for (const IsrPath::Push& push : path.pushes)
        stack[push.place] = push.term.value();
    if (path.at_once) return store_at_once(path);
    for (const IsrPath::Store& store : path.stores)
        *store.to = store.term.value();
}

}  // namespace puckloop::dspic
