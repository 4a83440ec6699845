#include "debug/profile/profile.h"

#include <algorithm>
#include <utility>

namespace puckloop::debug {

Profile::Profile(const DebugChip& chip) : chip_(chip), written_(chip.ram_end()) {}

Profile::Slot& Profile::slot(std::uint32_t pc) {
    const std::size_t index = pc / 2;
    if (index >= slots_.size()) slots_.resize(index + 1);
    Slot& slot = slots_[index];
    if (slot.size != 0) return slot;
    const Instruction instruction = chip_.instruction(pc);
    slot.flow = instruction.flow;
    slot.size = static_cast<std::uint8_t>(instruction.size);
    return slot;
}

std::map<std::uint32_t, Cost> Profile::costs() const {
    std::map<std::uint32_t, Cost> costs;
    for (std::size_t i = 0; i < slots_.size(); ++i)
        if (slots_[i].cost.instructions > 0) costs[static_cast<std::uint32_t>(2 * i)] = slots_[i].cost;
    return costs;
}

void Profile::account(std::uint64_t cycle) {
    if (!running_) return;
    const Cost cost{cycle - begun_, 1};
    slots_[pc_ / 2].cost += cost;
    total_ += cost;
}

void Profile::serve(std::uint32_t pc, std::uint64_t cycle) {
    // What taking it cost lies before its first instruction, and is its.
    entries_[pc] = taken_->first;
    frames_.push_back({taken_->second, pc, taken_->second, total_, {}, true});
    slot(pc).cost.cycles += cycle - begun_;
    total_.cycles += cycle - begun_;
    taken_.reset();
}

void Profile::follow(std::uint32_t pc) {
    if (!running_) return;
    if (flow_ == Flow::Call) enter(pc);
    if (flow_ == Flow::Return) leave(pc, false);
    if (flow_ == Flow::InterruptReturn) leave(pc, true);
}

bool Profile::instruction(std::uint32_t pc, std::uint64_t cycle) {
    account(cycle);
    if (taken_)
        serve(pc, cycle);
    else
        follow(pc);
    const Slot& here = slot(pc);
    running_ = true;
    pc_ = pc;
    begun_ = cycle;
    flow_ = here.flow;
    size_ = here.size;
    const std::uint16_t sp = chip_.stack_pointer();
    if (flow_ == Flow::Call && !based_ && sp >= chip_.ram_start() && sp < chip_.ram_end()) {
        based_ = true;
        if (!stack_) stack_ = Stack{sp, sp, pc};
    }
    if (based_ && sp >= chip_.ram_start() && sp < chip_.ram_end() &&
        (chip_.stack_grows_up() ? sp > stack_->peak : sp < stack_->peak)) {
        stack_->peak = sp;
        stack_->peak_pc = pc;
    }
    return true;
}

void Profile::enter(std::uint32_t pc) {
    entries_.try_emplace(pc);
    if (frames_.size() == kDeepest) frames_.erase(frames_.begin(), frames_.begin() + kDeepest / 2);
    frames_.push_back({pc_, pc, pc_ + size_, total_, {}, false});
}

void Profile::leave(std::uint32_t pc, bool from_interrupt) {
    // A return that goes where no call came from (a jump by the stack) leaves nothing.
    const auto fits = [&](const Frame& frame) {
        return frame.back == pc && frame.interrupt == from_interrupt;
    };
    const auto at = std::find_if(frames_.rbegin(), frames_.rend(), fits);
    if (at == frames_.rend()) return;
    for (auto left = at - frames_.rbegin() + 1; left > 0; --left)
        pop();
}

void Profile::pop() {
    const Frame frame = frames_.back();
    frames_.pop_back();
    const Cost whole{total_.cycles - frame.start.cycles, total_.instructions - frame.start.instructions};
    if (!frame.interrupt) {
        Calls& calls = calls_[{frame.site, frame.callee}];
        ++calls.times;
        calls.inclusive.cycles += whole.cycles - frame.apart.cycles;
        calls.inclusive.instructions += whole.instructions - frame.apart.instructions;
    }
    if (!frames_.empty()) frames_.back().apart += frame.interrupt ? whole : frame.apart;
}

void Profile::interrupt(int vector, std::uint32_t pc, std::uint64_t cycle) {
    account(cycle);
    if (taken_)
        serve(pc, cycle);  // interrupted before its first instruction
    else
        follow(pc);
    running_ = false;
    begun_ = cycle;
    taken_.emplace(vector, pc);
}

void Profile::reset(std::uint64_t cycle) {
    account(cycle);
    while (!frames_.empty())
        pop();
    running_ = based_ = false;
    taken_.reset();
}

void Profile::access(std::uint16_t address, int bytes, bool write) {
    for (int i = 0; i < bytes; ++i) {
        const auto at = static_cast<std::uint16_t>(address + i);
        if (at < chip_.ram_start() || at >= chip_.ram_end()) continue;
        if (write) {
            written_[at] = true;
        } else if (!written_[at] && !chip_.shared(at)) {
            ++unwritten_reads_;
            if (unwritten_.size() == kMostPlaces && !unwritten_.contains({pc_, at})) continue;
            Unwritten& found = unwritten_[{pc_, at}];
            if (found.times++ == 0) found = {at, pc_, begun_, 1};
        }
    }
}

void Profile::finish(std::uint64_t cycle) {
    account(cycle);
    running_ = false;
    while (!frames_.empty())
        pop();
}

std::vector<Profile::Unwritten> Profile::unwritten() const {
    std::vector<Unwritten> list;
    for (const auto& [key, found] : unwritten_)
        list.push_back(found);
    std::stable_sort(list.begin(), list.end(),
                     [](const Unwritten& a, const Unwritten& b) { return a.cycle < b.cycle; });
    return list;
}

}  // namespace puckloop::debug
