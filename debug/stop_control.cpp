#include "debug/stop_control.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace puckloop::debug {

void StopControl::remove_watch(const Watchpoint& watch) {
    if (const auto at = std::find(watches_.begin(), watches_.end(), watch); at != watches_.end())
        watches_.erase(at);
}

void StopControl::remove_bits(const BitWatch& bits) {
    const auto same = [&](const NotedBits& noted) { return noted.watch == bits; };
    if (const auto at = std::find_if(bits_.begin(), bits_.end(), same); at != bits_.end()) bits_.erase(at);
}

namespace {

std::uint32_t read_bits(const DebugChip& chip, const BitWatch& watch) {
    std::array<std::uint8_t, 4> bytes{};
    chip.read_memory(DebugChip::address_of_data(watch.start), std::span(bytes).first(watch.bytes));
    return (bytes[0] | bytes[1] << 8 | bytes[2] << 16 | std::uint32_t{bytes[3]} << 24) & watch.mask;
}

}  // namespace

void StopControl::note_bits() {
    for (NotedBits& noted : bits_)
        noted.value = read_bits(*chip_, noted.watch);
}

const BitWatch* StopControl::changed_bits() {
    const BitWatch* found = nullptr;
    for (NotedBits& noted : bits_) {
        const std::uint32_t now = read_bits(*chip_, noted.watch);
        const bool changed = now != noted.value && (!noted.watch.wanted || *noted.watch.wanted == now);
        if (changed && found == nullptr) found = &noted.watch;
        noted.value = now;
    }
    return found;
}

void StopControl::clear() {
    bits_.clear();
    breaks_.clear();
    watches_.clear();
}

void StopControl::begin(bool step) {
    mode_ = Mode::Run;
    step_ = step;
    first_ = true;
    begun_ = false;
    first_pc_ = chip_->pc();
    stop_.reset();
    note_bits();
    if (step || !watches_.empty() || !bits_.empty()) {
        chip_->set_stops({});
        chip_->set_instrument(this, !watches_.empty());
    } else {
        chip_->set_instrument(nullptr, false);
        std::vector<std::uint32_t> stops(breaks_.begin(), breaks_.end());
        stops.insert(stops.end(), ends_.begin(), ends_.end());
        chip_->set_stops(stops);
    }
}

void StopControl::begin_inside(bool step, bool inside) {
    mode_ = Mode::Run;
    step_ = step;
    first_ = !inside;
    begun_ = inside;
    first_pc_ = chip_->pc();
    stop_.reset();
    note_bits();
}

void StopControl::begin_search(bool steps, std::uint64_t position) {
    search_inside(steps, position);
    chip_->set_stops({});
    chip_->set_instrument(this, !steps && !watches_.empty());
}

void StopControl::search_inside(bool steps, std::uint64_t position) {
    mode_ = Mode::Search;
    step_ = steps;
    first_ = true;
    position_ = position;
    stop_.reset();
    found_.reset();
    note_bits();
}

void StopControl::begin_seek(std::uint64_t position) {
    seek_inside(position);
    chip_->set_stops({});
    chip_->set_instrument(this, false);
}

void StopControl::seek_inside(std::uint64_t position) {
    mode_ = Mode::Seek;
    position_ = position;
    stop_.reset();
}

std::optional<Stop> StopControl::end() {
    // Without an instrument the chip stands at a breakpoint if it stands at its address.
    if (mode_ == Mode::Run && !stop_ && ends_.contains(chip_->pc())) stop_ = Stop{Stop::Why::End};
    if (mode_ == Mode::Run && !stop_ && breaks_.contains(chip_->pc())) stop_ = Stop{Stop::Why::Break};
    mode_ = Mode::Idle;
    chip_->set_instrument(nullptr, false);
    return stop_;
}

bool StopControl::instruction(std::uint32_t pc, std::uint64_t cycle) {
    current_ = cycle;
    switch (mode_) {
    case Mode::Idle:
        return true;
    case Mode::Run:
        return run_on(pc);
    case Mode::Seek:
        return cycle < position_;
    case Mode::Search:
        if (cycle >= position_) return false;
        if (step_) {
            // A REPEAT is one step: neither its other iterations are, nor one that the search begins within.
            const bool goes_on = chip_->repeating() && (first_ || pc == first_pc_);
            if (!goes_on) found_ = Found{cycle, {Stop::Why::Step}};
            first_ = false;
            first_pc_ = pc;
        } else if (const BitWatch* bits = bits_.empty() ? nullptr : changed_bits(); bits != nullptr) {
            found_ = Found{cycle, {Stop::Why::Bits, {}, 0, *bits}};
        } else if (breaks_.contains(pc)) {
            found_ = Found{cycle, {Stop::Why::Break}};
        }
        return true;
    }
    return true;
}

bool StopControl::run_on(std::uint32_t pc) {
    if (stop_) return false;  // a watchpoint was met by the instruction before
    const bool first = std::exchange(first_, false);
    if (first && pc == first_pc_) {
        begun_ = true;
        return true;
    }
    if (const BitWatch* bits = bits_.empty() ? nullptr : changed_bits(); bits != nullptr) {
        stop_ = Stop{Stop::Why::Bits, {}, 0, *bits};
        return false;
    }
    if (ends_.contains(pc) || breaks_.contains(pc)) {
        stop_ = Stop{ends_.contains(pc) ? Stop::Why::End : Stop::Why::Break};
        return false;
    }
    if (!step_ || (begun_ && pc == first_pc_ && chip_->repeating())) return true;
    stop_ = Stop{Stop::Why::Step};
    return false;
}

void StopControl::access(std::uint16_t address, int bytes, bool write) {
    if (mode_ != Mode::Run && mode_ != Mode::Search) return;
    for (const Watchpoint& watch : watches_) {
        if (watch.kind == WatchKind::Write ? !write : watch.kind == WatchKind::Read && write) continue;
        const std::uint32_t end = address + static_cast<std::uint32_t>(bytes);
        if (end <= watch.start || address >= watch.start + watch.bytes) continue;
        const Stop stop{Stop::Why::Watch, watch, address};
        if (mode_ == Mode::Search)
            found_ = Found{current_, stop};
        else
            stop_ = stop;
        return;
    }
}

}  // namespace puckloop::debug
